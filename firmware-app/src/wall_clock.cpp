#include "wall_clock.hpp"

#include <sys/timex.h>

#include <array>
#include <ctime>
#include <system_error>

namespace octurn {

std::string utc_text(std::chrono::system_clock::time_point time, const char* format) {
  const std::time_t seconds =
      std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(time));
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), format, &utc)};
}

bool is_clock_synchronised(const std::filesystem::path& root) {
  timex state{};
  const int answer = ::adjtimex(&state);  // -1: the service's sandbox forbids the call
  std::error_code unknown;
  return (answer >= 0 && answer != TIME_ERROR) ||
         std::filesystem::exists(root / "run/systemd/timesync/synchronized", unknown);
}

}  // namespace octurn
