#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "octurn/calibrate.hpp"
#include "store/job.hpp"

namespace octurn {

/// The input of a build.
struct BuildInput {
  const Job& job;                       ///< the scan's job
  const std::filesystem::path& folder;  ///< the scan's folder, or that of its merged poses
  const BuildSettings& settings;
  /// Findings of all poses' scans, for a model of several poses. nullopt for one turn: its findings
  /// are determined during the build.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// Returns the findings of a scan's calibration and of its last look.
/// @param folder  of the scan. @throws Error  as `read_scan`
std::vector<CalibrationFinding> scan_findings(const Job& job, const std::filesystem::path& folder);

/// Called on any thread with the phase of a build and the number of snapshots read.
using BuildProgress = std::function<void(Phase phase, int snapshots_done)>;

/// Builds a model from the stored snapshots of a scan, and rates its quality. The settings decide
/// whether the sensor's pose is the configured one, the scan's solved one, or one that is solved
/// here.
///
/// @param file  path of the model, which is written atomically
/// @return a build without number and creation time; nullopt if stopped first
/// @throws Error  if the scan cannot be read, has no surface, or the disk is full
std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

}  // namespace octurn
