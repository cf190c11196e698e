#include "build/solve_rigs.hpp"

#include <algorithm>
#include <memory>

#include "calibration/solve_pose.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_kept_bytes = 16'000'000;  // cached depth images of all turns

/// Turns with the same configured pose come from one rig if their solved poses agree. Then all get
/// the mean, which is more accurate than each. Does nothing if a turn is registered already, or has
/// solved optics, with which its pose belongs.
void share_rig(std::vector<StoredTurn>& turns) {
  std::vector<SolvedPose> solved;
  const Eigen::Isometry3d& configured = turns.front().scan.platform_from_sensor;
  for (const StoredTurn& turn : turns) {
    const Scan& scan = turn.scan;
    if (turn.object_from_platform || !scan.solved || scan.solved->optics ||
        scan.platform_from_sensor.matrix() != configured.matrix()) {
      return;
    }
    solved.push_back(*scan.solved);
  }
  if (const auto shared = shared_pose(solved)) {
    for (StoredTurn& turn : turns) {
      turn.scan.solved->platform_from_sensor = *shared;
    }
  }
}

/// Solves the pose of a turn's sensor, and keeps the depth images that this has read.
void solve_rig(StoredTurn& turn, std::size_t kept_bytes, int threads, const std::stop_token& stop) {
  const SnapshotSource stored = stored_snapshots(turn.folder, turn.scan, stop);
  const auto kept = std::make_shared<KeptFrames>(stored.count, kept_bytes);
  const SnapshotSource read_once{.count = stored.count, .read = [&](std::size_t index) {
                                   Snapshot snapshot = stored.read(index);
                                   kept->keep(index, snapshot.frame);
                                   return snapshot;
                                 }};
  const ScanSolution solution = solve_scan(turn.folder, turn.scan, read_once, threads, stop);
  take_solution(turn.scan, solution);
  if (!solution.report.optics_differ) {  // else other depth images follow from the same files
    turn.kept = kept;
  }
}

}  // namespace

void solve_rigs(std::vector<StoredTurn>& turns, int threads, const std::stop_token& stop) {
  if (std::ranges::all_of(turns, &StoredTurn::is_rig_solved)) {
    return;
  }
  for (StoredTurn& turn : turns) {
    if (!turn.is_rig_solved && !turn.scan.solved && !turn.object_from_platform) {
      solve_rig(turn, max_kept_bytes / turns.size(), threads, stop);
    }
    turn.is_rig_solved = true;
  }
  if (!turns.front().scan.laser) {  // planes belong to their turn's pose
    share_rig(turns);
  }
}

}  // namespace octurn
