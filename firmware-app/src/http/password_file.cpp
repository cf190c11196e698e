#include "http/password_file.hpp"

#include <civetweb.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "http/message.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

constexpr std::size_t hash_digits = 32;
constexpr std::size_t max_file_bytes = 4096;  // this program writes a single line
constexpr std::size_t min_password_bytes = 8;
constexpr std::size_t max_password_bytes = 100;

std::string line_begin() { return std::string(page_user) + ":" + page_realm + ":"; }

bool is_hash(std::string_view text) {
  return text.size() == hash_digits &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace

void write_password_file(const std::filesystem::path& file, const std::string& password) {
  if (password.size() < min_password_bytes || password.size() > max_password_bytes) {
    throw Error(ErrorCode::bad_password,
                "the password has " + std::to_string(password.size()) + " bytes",
                "It needs " + std::to_string(min_password_bytes) + " to " +
                    std::to_string(max_password_bytes) + ".");
  }
  if (password.find('\0') != std::string::npos) {  // what follows it would not count
    throw Error(ErrorCode::bad_password, "the password contains the character U+0000",
                "Use letters, digits and signs.");
  }
  write_password_hash(file, digest_hash(page_user, page_realm, password));
}

void write_password_hash(const std::filesystem::path& file, const std::string& hash) {
  if (!is_hash(hash)) {
    throw Error(ErrorCode::bad_password, "the password's hash is no MD5",
                "It needs 32 digits, 0 to 9 and a to f.");
  }
  write_file(file, line_begin() + hash + "\n", 0600);
}

std::optional<std::string> read_password_hash(const std::filesystem::path& file) try {
  const std::string begin = line_begin();
  std::istringstream lines(read_regular_file(file, max_file_bytes).value_or(""));
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) {
      line.pop_back();
    }
    if (line.starts_with(begin) && is_hash(std::string_view(line).substr(begin.size()))) {
      return line.substr(begin.size());
    }
  }
  return std::nullopt;
} catch (const Error&) {
  return std::nullopt;
}

namespace {

constexpr std::string_view blanks = " \t";

void skip(std::string_view& text, std::string_view letters) {
  text.remove_prefix(std::min(text.find_first_not_of(letters), text.size()));
}

/// Takes characters from the front of a text, up to the first of `ends`.
std::string take_until(std::string_view& text, std::string_view ends) {
  const std::string_view taken = text.substr(0, text.find_first_of(ends));
  text.remove_prefix(taken.size());
  return std::string(taken);
}

/// Takes a quoted string after its opening quote; nothing if it has no closing quote.
std::optional<std::string> take_quoted(std::string_view& text) {
  std::string value;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') {
      text.remove_prefix(i + 1);
      return value;
    }
    if (text[i] == '\\' && ++i == text.size()) {
      break;
    }
    value += text[i];
  }
  return std::nullopt;
}

/// The member for a field of that name; null for a field that is not used.
std::string* find_field(DigestProof& proof, std::string_view name) {
  const std::array<std::pair<std::string_view, std::string*>, 8> fields{
      {{"username", &proof.user},
       {"realm", &proof.realm},
       {"nonce", &proof.nonce},
       {"uri", &proof.uri},
       {"qop", &proof.qop},
       {"nc", &proof.nc},
       {"cnonce", &proof.cnonce},
       {"response", &proof.response}}};
  const auto* const found = std::ranges::find_if(
      fields, [&](const auto& field) { return same_token(field.first, name); });
  return found == fields.end() ? nullptr : found->second;
}

}  // namespace

std::optional<DigestProof> parse_digest(std::string_view authorization) {
  if (!same_token(take_until(authorization, blanks), "Digest")) {
    return std::nullopt;
  }
  DigestProof proof;
  for (skip(authorization, ", \t"); !authorization.empty(); skip(authorization, ", \t")) {
    const std::string name = take_until(authorization, "= \t,");
    skip(authorization, blanks);
    if (!authorization.starts_with('=')) {
      return std::nullopt;
    }
    authorization.remove_prefix(1);
    skip(authorization, blanks);
    std::optional<std::string> value;
    if (authorization.starts_with('"')) {
      authorization.remove_prefix(1);
      value = take_quoted(authorization);
    } else {
      value = take_until(authorization, ", \t");
    }
    if (!value) {
      return std::nullopt;
    }
    if (std::string* const field = find_field(proof, name)) {
      *field = *value;
    }
  }
  return proof;
}

std::string digest_hash(const std::string& user, const std::string& realm,
                        const std::string& password) {
  std::array<char, 33> hash{};
  mg_md5(hash.data(), user.c_str(), ":", realm.c_str(), ":", password.c_str(), nullptr);
  return hash.data();
}

std::string digest_response(const DigestProof& proof, const std::string& hash,
                            const std::string& method) {
  std::array<char, 33> request{};
  mg_md5(request.data(), method.c_str(), ":", proof.uri.c_str(), nullptr);
  std::array<char, 33> response{};
  mg_md5(response.data(), hash.c_str(), ":", proof.nonce.c_str(), ":", proof.nc.c_str(), ":",
         proof.cnonce.c_str(), ":", proof.qop.c_str(), ":", request.data(), nullptr);
  return response.data();
}

}  // namespace octurn
