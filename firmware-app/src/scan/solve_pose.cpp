#include "scan/solve_pose.hpp"

namespace octurn {

CalibrationReport solve_pose(const std::filesystem::path& folder, const Scan& scan, int threads,
                             const std::stop_token& stop) {
  CalibrationTurn turn{.intrinsics = scan.intrinsics,
                       .platform_from_sensor = scan.platform_from_sensor,
                       .angles = {},
                       .read = {}};
  for (const Shot& shot : scan.shots) {
    turn.angles.push_back(shot.angle);
  }
  turn.read = [snapshots = stored_snapshots(folder, scan, stop)](std::size_t stop_index) {
    return snapshots.read(stop_index).frame;
  };
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
