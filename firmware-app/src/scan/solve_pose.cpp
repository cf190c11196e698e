#include "scan/solve_pose.hpp"

#include "octurn/error.hpp"

namespace octurn {

CalibrationReport solve_pose(const Scan& scan, const SnapshotSource& snapshots, int threads) {
  if (!is_one_turn(scan)) {
    throw Error(ErrorCode::scan_malformed,
                "the scan is of several poses, and a pose is solved from one turn",
                "Solve each turn before they are merged.");
  }
  CalibrationTurn turn{.intrinsics = scan.intrinsics,
                       .platform_from_sensor = scan.platform_from_sensor,
                       .angles = {},
                       .has_sensor_map = scan.sensor_map != nullptr,
                       .read = {}};
  for (const Shot& shot : scan.shots) {
    turn.angles.push_back(shot.angle);
  }
  turn.read = [&snapshots](std::size_t stop) { return snapshots.read(stop).frame; };
  return calibrate(turn, threads);
}

SolvedPose to_solved_pose(const CalibrationReport& report) {
  return {.platform_from_sensor = report.platform_from_sensor,
          .position_sigma = report.position_sigma,
          .direction_sigma = report.direction_sigma,
          .before = report.before,
          .after = report.after};
}

}  // namespace octurn
