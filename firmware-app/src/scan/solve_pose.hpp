#pragma once

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

}  // namespace octurn
