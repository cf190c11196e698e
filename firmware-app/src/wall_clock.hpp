#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

namespace octurn {

/// Formats a time in UTC. @param format  of strftime(3); its text has at most 31 characters
std::string utc_text(std::chrono::system_clock::time_point time, const char* format);

inline constexpr const char* rfc3339 = "%Y-%m-%dT%H:%M:%SZ";

/// Whether a time server has set the kernel's clock lately, as adjtimex(2) or systemd-timesyncd
/// says. @param root  of the file system
bool is_clock_synchronised(const std::filesystem::path& root = "/");

/// The time of day, and whether to believe it: without a network, a Pi begins with the date of its
/// image, and anybody may have set it.
struct WallClock {
  std::function<std::chrono::system_clock::time_point()> now = std::chrono::system_clock::now;
  std::function<bool()> is_right = [] { return is_clock_synchronised(); };
};

}  // namespace octurn
