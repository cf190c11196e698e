#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>

#include "octurn/calibrate.hpp"
#include "octurn/scan_folder.hpp"
#include "store/job.hpp"

namespace octurn {

/// Solves the sensor's pose of a stored scan from its snapshots, starting at the configured pose.
///
/// @param snapshots  of the scan without a solved pose, whose optics would be in them
/// @throws Error "scan-malformed"  if the scan is of several turns; and errors of `snapshots`
CalibrationReport solve_pose(const Scan& scan, const SnapshotSource& snapshots, int threads);

/// Returns the part of an accepted report that scan.json stores.
SolvedPose to_solved_pose(const CalibrationReport& report);

/// Returns what a job stores of a report.
ScanCalibration to_scan_calibration(const CalibrationReport& report);

/// Result of solving a stored scan.
struct ScanSolution {
  CalibrationReport report = {};
  SolvedPose solved = {};      ///< the part that scan.json stores, if accepted
  bool replaces_told = false;  ///< accepted, and differs from the configured pose or planes
};

/// Solves the pose of a stored scan as above; of a laser-line scan, the lasers' planes as well.
/// @param snapshots  of the scan; not read for a laser-line scan
/// @throws Stopped  and as above
ScanSolution solve_scan(const std::filesystem::path& folder, const Scan& scan,
                        const SnapshotSource& snapshots, int threads, const std::stop_token& stop);

/// Gives a scan the solved pose, and the angles at which its platform stood, if they replace the
/// configured ones. @return whether they do
bool take_solution(Scan& scan, const ScanSolution& solution);

/// Returns the pose of a rig that did not move between turns: the mean of the turns' solved poses,
/// weighted by 1 / sigma^2.
/// @return nullopt for fewer than two turns, or if one is more than three sigmas off the mean
std::optional<Eigen::Isometry3d> shared_pose(std::span<const SolvedPose> turns);

}  // namespace octurn
