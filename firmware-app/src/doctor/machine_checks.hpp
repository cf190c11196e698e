#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "doctor/finding.hpp"

namespace octurn {

// Checks of the machine. A `root` is the folder that /proc, /sys and /run are in: "/" outside of
// tests.

/// @param free        bytes that this program may still write into the folder of the scans
/// @param bytes_each  what a scan takes at most
Finding check_disk(std::uint64_t free, std::uint64_t bytes_each);

/// Whether there is as much memory as a reconstruction may use.
/// @param limit  bytes, for the whole process; 0 is no limit
Finding check_memory(const std::filesystem::path& root, std::size_t limit);

Finding check_temperature(const std::filesystem::path& root);

/// Whether a Raspberry Pi's supply holds its voltage.
Finding check_supply(const std::filesystem::path& root);

/// Whether a Raspberry Pi runs slower than it could.
Finding check_throttling(const std::filesystem::path& root);

/// Whether somebody has set the clock: a Raspberry Pi has none that runs without power.
/// @param synchronised  what the kernel says of it
Finding check_clock(const std::filesystem::path& root, std::chrono::system_clock::time_point now,
                    bool synchronised);

/// Whether the kernel has been told the time by a time server, and lately.
bool is_clock_synchronised();

}  // namespace octurn
