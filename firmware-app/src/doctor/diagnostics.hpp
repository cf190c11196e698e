#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "appliance/appliance.hpp"
#include "config.hpp"
#include "doctor/finding.hpp"
#include "run/status_board.hpp"
#include "store/job.hpp"
#include "zip_file.hpp"

namespace octurn {

// Files for remote support, of at most 4 MiB without a recording of USB. They contain no secrets,
// no names of scans and no sensor data.

/// `versions.json`, `settings.json`, `doctor.json` and `system.txt`.
/// @param config  in force
/// @param root    folder with /etc, /proc and /sys: "/" except in tests
std::vector<ArchivedFile> machine_diagnostics(const Config& config,
                                              std::span<const Finding> findings,
                                              const std::filesystem::path& root = "/");

/// `calibration.json`: the poses and the sensors' optics in force, and the earlier ones.
/// @param config  with the configured pose
ArchivedFile calibration_diagnostics(const Config& config);

/// `scans.json` of a data folder, for a program that is not its daemon.
ArchivedFile scan_diagnostics(const std::filesystem::path& data);

/// `devices.json`, `scans.json` and `log.txt` of a daemon.
/// @param scans  the newest first
/// @param log    the newest lines of the log
std::vector<ArchivedFile> daemon_diagnostics(const Status& status, std::span<const Job> scans,
                                             std::string log);

/// `errors.txt`, if the appliance has logged errors.
std::vector<ArchivedFile> appliance_diagnostics(const Appliance& appliance);

}  // namespace octurn
