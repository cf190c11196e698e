#include "capture/measure_laser_turn.hpp"

#include <system_error>
#include <utility>

#include "calibration/solve_pose.hpp"
#include "capture/plan.hpp"
#include "capture/scan_of_rig.hpp"
#include "capture/slice.hpp"
#include "capture/take_stop.hpp"
#include "octurn/units.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// A temporary scan folder. The destructor removes it; the constructor removes one that a killed
/// process left.
class FolderOfTurn {
 public:
  explicit FolderOfTurn(const fs::path& data) : path_(data / "calibration-turn") { remove(); }
  ~FolderOfTurn() { remove(); }
  FolderOfTurn(const FolderOfTurn&) = delete;
  FolderOfTurn& operator=(const FolderOfTurn&) = delete;

  const fs::path& path() const { return path_; }

 private:
  void remove() {
    std::error_code ignored;  // writing into it reports the problem
    fs::remove_all(path_, ignored);
  }

  fs::path path_;
};

Slice slice_of_strips(const fs::path& folder, const Scan& scan, const std::stop_token& stop) {
  Slice slice;
  const SnapshotSource snapshots = readable_snapshots(folder, scan, stop);
  for (std::size_t i = 0; i < snapshots.count; ++i) {
    const Snapshot snapshot = snapshots.read(i);
    for (const LineStrip& strip : snapshot.strips) {
      for (std::size_t point = 0; point < strip.own_points; ++point) {
        add_to_slice(slice, strip.points[point].cast<double>());
      }
    }
  }
  return thinned(slice);
}

TurnReport solve_turn(const fs::path& folder, Scan& scan, int threads,
                      const std::stop_token& stop) {
  ScanSolution solution = solve_scan(folder, scan, {}, threads, stop);
  TurnReport report{.calibration = std::move(solution.report),
                    .configured = scan.laser->lasers,
                    .lasers = solution.solved.lasers,
                    .replaces_told = solution.replaces_told};
  for (const Shot& shot : scan.shots) {
    report.angles.push_back(shot.angle);
  }
  report.before = slice_of_strips(folder, scan, stop);
  if (report.calibration.accepted) {
    scan.solved = std::move(solution.solved);
    report.after = slice_of_strips(folder, scan, stop);
  }
  return report;
}

}  // namespace

std::optional<TurnReport> measure_laser_turn(const ScanSettings& settings, const fs::path& data,
                                             int threads, Rig& rig, const std::stop_token& stop,
                                             const ScanObserver& observer) try {
  const FolderOfTurn folder(data);
  Turntable& turntable = rig.turntable();
  const int steps = turntable.steps_per_turn();
  Scan scan = scan_of_rig(rig, settings);
  begin_scan(scan, settings, folder.path(), rig);
  for (const std::int64_t position :
       stop_positions(turntable.position(), steps, settings.snapshots)) {
    const Stop at{.index = static_cast<int>(scan.shots.size()), .position = position};
    const double angle = radians_from_degrees(angle_deg_at(position, steps));
    if (!take_stop(rig, at, angle, folder.path(), scan, stop, observer)) {
      return std::nullopt;
    }
  }
  observer.on_progress(Phase::calibrating, settings.snapshots);
  return solve_turn(folder.path(), scan, threads, stop);
} catch (const Stopped&) {
  return std::nullopt;
}

}  // namespace octurn
