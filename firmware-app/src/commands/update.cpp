#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "signal_stop.hpp"

namespace octurn {

void install_update(const std::filesystem::path& file) {
  constexpr const char* program = "/usr/lib/octurn/update";  // of the image
  if (::access(program, F_OK) != 0) {
    throw Error(ErrorCode::not_an_appliance,
                "updates are for the appliance's image, and this is none",
                "A newer package updates this machine: apt install ./octurn_*.deb");
  }
  if (::geteuid() != 0) {
    throw Error(ErrorCode::not_root, "only root may install an update",
                "Use the page, which asks root for it.");
  }
  std::string name = program;
  std::string argument = std::filesystem::absolute(file);  // which begins with no hyphen
  std::array<char*, 3> words{name.data(), argument.data(), nullptr};
  unblock_signals();
  ::execv(program, words.data());
  throw Error(ErrorCode::update_failed,
              std::string(program) + ": " + std::generic_category().message(errno));
}

}  // namespace octurn
