#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "signal_stop.hpp"

namespace octurn {

void install_update(const UpdateArguments& arguments) {
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
  std::string older = "--older";
  std::string file = std::filesystem::absolute(arguments.file);  // begins with '/', not with '-'
  std::array<char*, 4> words{name.data(), older.data(), file.data(), nullptr};
  if (!arguments.takes_older) {
    words = {name.data(), file.data(), nullptr};
  }
  unblock_signals();
  ::execv(program, words.data());
  throw Error(ErrorCode::update_failed,
              std::string(program) + ": " + std::generic_category().message(errno));
}

}  // namespace octurn
