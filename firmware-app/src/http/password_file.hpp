#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace octurn {

// Who may open the page, where not everybody may: one user, in a file of HTTP Digest (RFC 7616), as
// Apache's `htdigest` writes it. It holds no password, but what a client proves to know it by.

inline constexpr const char* page_realm = "Octurn";
inline constexpr const char* page_user = "octurn";

/// Makes the file, which only its owner can read, or gives it another password.
/// @throws Error "bad-password" if it is empty or longer than 100 bytes; "write-failed"
void write_password_file(const std::filesystem::path& file, const std::string& password);

/// What clients prove to know the password by, `digest_hash`. Nothing if no client can: the file
/// cannot be read, or does not have the user.
std::optional<std::string> read_password_hash(const std::filesystem::path& file);

}  // namespace octurn
