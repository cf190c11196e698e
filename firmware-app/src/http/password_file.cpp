#include "http/password_file.hpp"

#include <sstream>
#include <string_view>

#include "http/digest.hpp"
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

}  // namespace octurn
