#pragma once

#include <filesystem>
#include <stop_token>

#include "octurn/calibrate.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Solves the pose of a stored scan from its own snapshots, from the told pose on.
///
/// @param stop  once requested, the call throws `Stopped`
/// @throws Error  of a snapshot that cannot be read, as `read_snapshot`
CalibrationReport solve_pose(const std::filesystem::path& folder, const Scan& scan, int threads,
                             const std::stop_token& stop = {});

/// What scan.json keeps of an accepted report.
SolvedPose to_solved_pose(const CalibrationReport& report);

}  // namespace octurn
