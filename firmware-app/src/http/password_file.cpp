#include "http/password_file.hpp"

#include <civetweb.h>
#include <sys/stat.h>

#include "octurn/error.hpp"

namespace octurn {

void write_password_file(const std::filesystem::path& file, const std::string& password) {
  constexpr std::size_t most = 100;
  if (password.empty() || password.size() > most) {
    throw Error("bad-password", "the password has " + std::to_string(password.size()) + " bytes",
                "It needs one at least, and at most " + std::to_string(most) + ".");
  }
  const mode_t others = ::umask(S_IRWXG | S_IRWXO);
  const int written =
      mg_modify_passwords_file(file.c_str(), page_realm, page_user, password.c_str());
  ::umask(others);
  if (written != 1) {
    throw Error("write-failed", file.string() + ": cannot be written",
                "Check that its folder exists and that this program may write there.");
  }
}

}  // namespace octurn
