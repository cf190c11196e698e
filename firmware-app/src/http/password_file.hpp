#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace octurn {

// The page's only user, in a file for HTTP Digest (RFC 7616), as Apache's `htdigest` writes it. It
// holds a hash and not the password.

inline constexpr const char* page_realm = "Octurn";
inline constexpr const char* page_user = "octurn";

/// Writes the file, which only its owner can read, with a new password.
/// @throws Error "bad-password" if it does not have 8 to 100 bytes, or contains U+0000;
/// "write-failed"
void write_password_file(const std::filesystem::path& file, const std::string& password);

/// Writes the file of a password whose `digest_hash` is given.
/// @throws Error "bad-password" if that is no 32 lower-case hexadecimal digits; "write-failed"
void write_password_hash(const std::filesystem::path& file, const std::string& hash);

/// The `digest_hash` of the password. Nothing if the file cannot be read, or does not have the
/// user.
std::optional<std::string> read_password_hash(const std::filesystem::path& file);

}  // namespace octurn
