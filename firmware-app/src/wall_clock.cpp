#include "wall_clock.hpp"

#include <sys/timex.h>

#include <system_error>

namespace octurn {

bool is_clock_synchronised(const std::filesystem::path& root) {
  timex state{};
  const int answer = ::adjtimex(&state);  // -1: the service's sandbox forbids the call
  std::error_code unknown;
  return (answer >= 0 && answer != TIME_ERROR) ||
         std::filesystem::exists(root / "run/systemd/timesync/synchronized", unknown);
}

}  // namespace octurn
