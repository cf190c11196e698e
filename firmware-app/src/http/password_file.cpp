#include "http/password_file.hpp"

#include <civetweb.h>
#include <sys/stat.h>

#include <array>

#include "octurn/atomic_file.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

/// Files that are made as long as it lives are their owner's alone.
class OwnFiles {
 public:
  OwnFiles() = default;
  ~OwnFiles() { ::umask(before_); }
  OwnFiles(const OwnFiles&) = delete;
  OwnFiles& operator=(const OwnFiles&) = delete;

 private:
  mode_t before_ = ::umask(S_IRWXG | S_IRWXO);
};

}  // namespace

void write_password_file(const std::filesystem::path& file, const std::string& password) {
  constexpr std::size_t most = 100;
  if (password.empty() || password.size() > most) {
    throw Error("bad-password", "the password has " + std::to_string(password.size()) + " bytes",
                "It needs one at least, and at most " + std::to_string(most) + ".");
  }
  std::array<char, 33> hash{};
  mg_md5(hash.data(), page_user, ":", page_realm, ":", password.c_str(), nullptr);
  const std::string line = std::string(page_user) + ":" + page_realm + ":" + hash.data() + "\n";
  const OwnFiles only;
  write_file(file, line);
}

}  // namespace octurn
