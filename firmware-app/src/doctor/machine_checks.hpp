#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "doctor/finding.hpp"

namespace octurn {

// Checks of the machine. `root` is the folder with /proc, /sys and /run: "/" except in tests.

/// Whether the page's settings are as they were stored.
/// @param trouble  of ConfigStore
Finding check_settings(const std::string& trouble);

/// Disk space of a scan, in bytes.
struct ScanBytes {
  std::uint64_t largest = 0;  ///< maximum; a scan starts only with this much free
  std::uint64_t usual = 0;    ///< expected size of a finished scan
};

/// Whether the disk has room for several scans.
/// @param free  bytes that this program may still write into the data folder
Finding check_disk(std::uint64_t free, const ScanBytes& scan);

/// Whether the memory that a reconstruction may use is available.
/// @param limit  bytes, for the whole process; 0 is no limit
Finding check_memory(const std::filesystem::path& root, std::size_t limit);

/// Whether the processor is cool enough to keep its clock.
Finding check_temperature(const std::filesystem::path& root);

/// Whether a Raspberry Pi's supply voltage has stayed above 4.63 V. Nothing where the kernel does
/// not tell: Raspberry Pi's own does, Debian's has no driver for it.
std::optional<Finding> check_supply(const std::filesystem::path& root);

/// Whether a Raspberry Pi's firmware has lowered the clock of the processor. Nothing where the
/// kernel does not tell.
std::optional<Finding> check_throttling(const std::filesystem::path& root);

/// Whether the clock is right. A Raspberry Pi has no clock that runs without power.
/// @param synchronised  as `is_clock_synchronised` says
Finding check_clock(const std::filesystem::path& root, std::chrono::system_clock::time_point now,
                    bool synchronised);

}  // namespace octurn
