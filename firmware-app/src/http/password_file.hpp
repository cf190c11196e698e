#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

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

/// A client's proof that it knows a password, by HTTP Digest (RFC 7616, section 3.4).
struct DigestProof {
  std::string user = {};
  std::string realm = {};
  std::string nonce = {};   ///< of the server's challenge
  std::string uri = {};     ///< target of the request that the proof is for
  std::string qop = {};     ///< "auth", the only quality of protection here
  std::string nc = {};      ///< how often the client has used the nonce, hexadecimal
  std::string cnonce = {};  ///< the client's own nonce
  std::string response = {};
};

/// Parses an Authorization header; nothing if it is of another scheme, or malformed.
std::optional<DigestProof> parse_digest(std::string_view authorization);

/// MD5 of user, realm and password, hexadecimal: H(A1) of section 3.4.2, which a server keeps.
std::string digest_hash(const std::string& user, const std::string& realm,
                        const std::string& password);

/// The expected response for a proof's other fields (section 3.4.1).
///
/// @param hash    of the user, by `digest_hash`
/// @param method  of the request
std::string digest_response(const DigestProof& proof, const std::string& hash,
                            const std::string& method);

}  // namespace octurn
