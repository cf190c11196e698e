#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "appliance/appliance.hpp"
#include "config.hpp"
#include "doctor/finding.hpp"
#include "scan/job.hpp"
#include "scan/status_board.hpp"
#include "zip_archive.hpp"

namespace octurn {

// What somebody needs who helps from afar, as files: no secret, no name that a person gave a scan,
// nothing that a sensor saw, and at most 4 MiB.

/// `versions.json`, `settings.json`, `doctor.json` and `system.txt`.
/// @param config  in force
/// @param root    that /etc, /proc and /sys are in: "/" outside of tests
std::vector<ArchivedFile> diagnostics_of_machine(const Config& config,
                                                 std::span<const Finding> findings,
                                                 const std::filesystem::path& root = "/");

/// `devices.json`, `scans.json` and `log.txt` of a daemon.
/// @param scans  the newest first
/// @param log    its last lines
std::vector<ArchivedFile> diagnostics_of_daemon(const Status& status, std::span<const Job> scans,
                                                std::string log);

/// `errors.txt`, if there are any.
std::vector<ArchivedFile> diagnostics_of_appliance(const Appliance& appliance);

}  // namespace octurn
