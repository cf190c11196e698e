#pragma once

#include <chrono>
#include <string>

namespace octurn {

/// Formats a time in UTC. @param format  of strftime(3); its text has at most 31 characters
std::string utc_text(std::chrono::system_clock::time_point time, const char* format);

inline constexpr const char* rfc3339 = "%Y-%m-%dT%H:%M:%SZ";

}  // namespace octurn
