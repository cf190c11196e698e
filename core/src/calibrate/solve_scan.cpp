#include <utility>

#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

/// @param snapshots  of the scan without a solved pose, whose optics would be in them
CalibrationReport solve_pose(const Scan& scan, const SnapshotSource& snapshots, int threads) {
  if (!is_one_turn(scan)) {
    throw Error(ErrorCode::scan_malformed,
                "the scan is of several poses, and a pose is solved from one turn",
                "Solve each turn before they are merged.");
  }
  Scan configured = scan;
  configured.solved.reset();
  CalibrationTurn turn{.intrinsics = model_intrinsics(configured, configured.shots.front()),
                       .platform_from_sensor = scan.platform_from_sensor,
                       .angles = {},
                       .has_sensor_map = scan.sensor_map != nullptr,
                       .optics = scan.optics,
                       .read = {}};
  for (const Shot& shot : scan.shots) {
    turn.angles.push_back(shot.angle);
  }
  turn.read = [&snapshots](std::size_t stop) { return snapshots.read(stop).frame; };
  return calibrate(turn, threads);
}

}  // namespace

SolvedPose to_solved_pose(const CalibrationReport& report) {
  return {.platform_from_sensor = report.platform_from_sensor,
          .position_sigma = report.position_sigma,
          .direction_sigma = report.direction_sigma,
          .before = report.before,
          .after = report.after,
          .optics = report.optics_differ ? report.optics : std::nullopt};
}

ScanSolution solve_scan(const std::filesystem::path& folder, const Scan& scan,
                        const SnapshotSource& snapshots, int threads, const std::stop_token& stop) {
  const LaserCalibration found =
      scan.laser ? calibrate_lasers(folder, scan, threads, stop)
                 : LaserCalibration{.report = solve_pose(scan, snapshots, threads)};
  const CalibrationReport& report = found.report;
  ScanSolution solution{
      .report = report,
      .solved = to_solved_pose(report),
      .replaces_told = report.accepted && (found.moved_a_plane || !report.confirms_told())};
  solution.solved.lasers = found.lasers;
  return solution;
}

bool take_solution(Scan& scan, const ScanSolution& solution) {
  if (!solution.replaces_told) {
    return false;
  }
  scan.solved = solution.solved;
  const std::vector<double>& slipped = solution.report.slipped;
  for (std::size_t stop = 0; stop < scan.shots.size(); ++stop) {
    scan.shots[stop].slipped = stop < slipped.size() ? slipped[stop] : 0;
  }
  return true;
}

}  // namespace octurn
