#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "octurn/calibrate.hpp"
#include "scan/job.hpp"

namespace octurn {

/// The input of a build.
struct BuildInput {
  const Job& job;                       ///< of the scan
  const std::filesystem::path& folder;  ///< of the scan, or of all its poses merged; read only
  const BuildSettings& settings;
  /// Of several poses: the findings of their scans. Of one turn they are read from `folder`.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// The findings of a scan: of its own calibration, and of its last look.
/// @param folder  of the scan. @throws Error  as `read_scan`
std::vector<CalibrationFinding> scan_findings(const Job& job, const std::filesystem::path& folder);

/// Called on any thread with the phase of a build and the number of snapshots read.
using BuildProgress = std::function<void(Phase phase, int snapshots_done)>;

/// Builds a model from the stored snapshots of a scan, and judges it. The sensor's pose is the told
/// one, the one that the scan solved, or one that is solved here, by the settings.
///
/// @param file  of the model, which appears whole or not at all
/// @return a build without number and time; nothing if stopped first
/// @throws Error  if the scan cannot be read, has no surface, or the disk is full
std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

}  // namespace octurn
