#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>

#include "octurn/calibrate.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Solves the pose of a stored scan from its own snapshots, from the told pose on.
///
/// @param snapshots  of the scan
/// @throws Error "scan-malformed"  if the scan is of several turns; and what a read throws
CalibrationReport solve_pose(const Scan& scan, const SnapshotSource& snapshots, int threads);

/// What scan.json keeps of an accepted report.
SolvedPose to_solved_pose(const CalibrationReport& report);

/// What solving a stored scan tells.
struct ScanSolution {
  CalibrationReport report = {};
  SolvedPose solved = {};      ///< what scan.json keeps of it if it is accepted
  bool replaces_told = false;  ///< accepted, and more than what the rig was told already
};

/// Solves the pose of a stored scan as above; of one by laser line, the lasers' planes as well.
/// @param snapshots  of the scan; not read of one by laser line
/// @throws Stopped  and as above
ScanSolution solve_scan(const std::filesystem::path& folder, const Scan& scan,
                        const SnapshotSource& snapshots, int threads, const std::stop_token& stop);

/// The pose of a rig that stood still from turn to turn: the mean of what each turn solved,
/// weighted by its sigmas.
/// @return none, if there are fewer than two, or one is more than three sigmas off the mean
std::optional<Eigen::Isometry3d> shared_pose(std::span<const SolvedPose> turns);

}  // namespace octurn
