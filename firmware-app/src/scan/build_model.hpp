#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "octurn/calibrate.hpp"
#include "scan/job.hpp"

namespace octurn {

/// What a build works on.
struct BuildInput {
  const Job& job;                       ///< of the scan
  const std::filesystem::path& folder;  ///< of the same, or of its poses; nothing in it is changed
  const BuildSettings& settings;
  /// Of several poses: what was found as they were scanned. Of one turn it is found here.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// What was found as a scan was taken: by its own calibration, and by its last look.
/// @param folder  of the scan. @throws Error  as `read_scan`
std::vector<CalibrationFinding> scan_findings(const Job& job, const std::filesystem::path& folder);

/// Told on any thread what a build is doing, and how many snapshots it has read.
using BuildProgress = std::function<void(Phase phase, int snapshots_done)>;

/// Builds a model from the stored snapshots of a scan and judges it. The pose is the told one, or
/// that which the scan has solved, or else one that is solved now.
///
/// @param file  of the model, which appears whole or not at all
/// @return a build without number and time; nothing if stopped first
/// @throws Error  if the scan cannot be read, has no surface, or the disk is full
std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

}  // namespace octurn
