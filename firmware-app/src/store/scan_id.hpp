#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>
#include <string>
#include <string_view>

namespace octurn {

/// The time in a scan's id, in steps of 20 us.
using ScanTime = std::chrono::sys_time<std::chrono::duration<std::int64_t, std::ratio<1, 50000>>>;

/// Whether a text has the form of a scan's id, "20261121-081500-3f2a". No other text may become
/// part of a path.
bool is_scan_id(std::string_view text);

/// Formats date and time of day (UTC) and the fraction of the second, so that ids sort by time.
std::string to_scan_id(ScanTime time);

/// Returns the time of an id. @param id  of the form that `is_scan_id` checks
ScanTime to_time(const std::string& id);

}  // namespace octurn
