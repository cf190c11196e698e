#include "http/password_file.hpp"

#include <civetweb.h>

#include <array>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {

void write_password_file(const std::filesystem::path& file, const std::string& password) {
  constexpr std::size_t most = 100;
  if (password.empty() || password.size() > most) {
    throw Error(ErrorCode::bad_password,
                "the password has " + std::to_string(password.size()) + " bytes",
                "It needs one at least, and at most " + std::to_string(most) + ".");
  }
  std::array<char, 33> hash{};
  mg_md5(hash.data(), page_user, ":", page_realm, ":", password.c_str(), nullptr);
  const std::string line = std::string(page_user) + ":" + page_realm + ":" + hash.data() + "\n";
  write_file(file, line, 0600);
}

}  // namespace octurn
