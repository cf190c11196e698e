#include "capture/calibration_turn.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "calibration/lens_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/plan.hpp"
#include "capture/scan_of_rig.hpp"
#include "capture/take_depth_image.hpp"
#include "capture/take_pictures.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/optics_json.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"
#include "store/job_json.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

// Bounds of a slice, metres: the space above the platform.
constexpr double half_thickness = 0.001;
constexpr double radius = 0.17;
constexpr double bottom = -0.02;
constexpr double top = 0.4;
constexpr std::size_t max_points = 3000;  // enough for a picture of some hundred pixels

/// Adds a point if it lies in the slice. @param point  metres, object's frame
void add_to_slice(Slice& slice, const Eigen::Vector3d& point) {
  if (std::abs(point.y()) <= half_thickness && std::abs(point.x()) <= radius &&
      point.z() >= bottom && point.z() <= top) {
    slice.emplace_back(point.x(), point.z());
  }
}

}  // namespace

Slice thinned(const Slice& slice) {
  const std::size_t step = slice.size() / max_points + 1;
  Slice some;
  for (std::size_t i = 0; i < slice.size(); i += step) {
    some.push_back(slice[i]);
  }
  return some;
}

namespace {

using nlohmann::json;

/// Adds the points of one depth image that lie in the slice.
void add_frame(Slice& slice, const DepthFrame& frame, const Intrinsics& lens,
               const Eigen::Isometry3d& object_from_sensor) {
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double z =
          frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                      static_cast<std::size_t>(u)] *
          lens.depth_unit;
      if (!(z > 0)) {
        continue;
      }
      add_to_slice(slice, object_from_sensor * (z * pixel_ray(lens, u, v)));
    }
  }
}

/// @param optics  that replace the sensor's own, if any
Slice slice_of_frames(const CalibrationTurn& turn, const Eigen::Isometry3d& platform_from_sensor,
                      const std::optional<SolvedOptics>& optics) {
  Slice slice;
  for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
    const Eigen::Isometry3d pose = object_from_sensor(platform_from_sensor, turn.angles[stop]);
    if (optics) {
      add_frame(slice, rectified(turn.read(stop), turn.intrinsics, optics->value),
                rectified(turn.intrinsics, optics->value), pose);
    } else {
      add_frame(slice, turn.read(stop), turn.intrinsics, pose);
    }
  }
  return thinned(slice);
}

json to_json(const Slice& slice) {
  json points = json::array();
  for (const Eigen::Vector2d& point : slice) {
    points.push_back({std::round(mm_from_metres(point.x()) * 100) / 100,
                      std::round(mm_from_metres(point.y()) * 100) / 100});
  }
  return points;
}

json to_json(const TurnReport& report) {
  const bool has_lasers = !report.lasers.empty();
  json object = has_lasers ? to_json(report.calibration, report.angles, report.lasers)
                           : to_json(report.calibration, report.angles);
  if (has_lasers) {
    object["confirms_told"] = report.calibration.accepted && !report.replaces_told;
  }
  object["slice_mm"] = {{"before", to_json(report.before)}, {"after", to_json(report.after)}};
  return object;
}

json lens_report_json(const CalibrationRun& run) {
  json report = to_json(*run.lens);
  report["optics"] = run.optics ? to_json(*run.optics) : json();
  return report;
}

json report_json(const CalibrationRun& run) {
  return run.report ? to_json(*run.report)
         : run.wall ? to_json(*run.wall)
         : run.lens ? lens_report_json(run)
                    : json();
}

}  // namespace

json to_json(const CalibrationRun& run) {
  constexpr std::array<std::string_view, 3> kinds{"turn", "wall", "lens"};
  constexpr std::array<std::string_view, 5> states{"running", "done", "refused", "failed",
                                                   "cancelled"};
  constexpr std::array<std::string_view, 3> phases{"turning", "solving", "looking"};
  return {{"kind", kinds[static_cast<std::size_t>(run.kind)]},
          {"state", states[static_cast<std::size_t>(run.state)]},
          {"phase", phases[static_cast<std::size_t>(run.phase)]},
          {"stop", run.stop},
          {"stops", run.stops},
          {"report", report_json(run)},
          {"look", run.look ? to_json(*run.look) : json()},
          {"error", run.failure ? to_json(*run.failure) : json()}};
}

std::optional<TurnReport> measure_turn(const ScanSettings& settings,
                                       const std::shared_ptr<const SensorMap>& map, int threads,
                                       Rig& rig, const std::stop_token& stop,
                                       const ScanObserver& observer) {
  Turntable& turntable = rig.turntable();
  const int steps = turntable.steps_per_turn();
  Scan scan = scan_of_sensor(rig, settings);
  scan.sensor_map = map;
  CalibrationTurn turn{.intrinsics = model_intrinsics(scan, {}),
                       .platform_from_sensor = settings.platform_from_sensor,
                       .has_sensor_map = map != nullptr,
                       .optics = scan.optics};
  std::vector<DepthFrame> frames;
  for (const std::int64_t position :
       stop_positions(turntable.position(), steps, settings.snapshots)) {
    std::optional<DepthFrame> frame =
        take_depth_image(rig, {.index = static_cast<int>(frames.size()), .position = position},
                         settings, stop, observer);
    if (!frame) {
      return std::nullopt;
    }
    frames.push_back(make_snapshot(*std::move(frame), scan, {}).frame);
    turn.angles.push_back(radians_from_degrees(angle_deg_at(position, steps)));
  }
  observer.on_progress(Phase::calibrating, settings.snapshots);
  turn.read = [&](std::size_t index) {
    throw_if_stopped(stop);
    return frames[index];
  };
  try {
    TurnReport report{.calibration = calibrate(turn, threads),
                      .angles = turn.angles,
                      .configured_pose = turn.platform_from_sensor};
    report.replaces_told = report.calibration.accepted && !report.calibration.confirms_told();
    report.before = slice_of_frames(turn, turn.platform_from_sensor, {});
    if (report.calibration.accepted) {
      report.after = slice_of_frames(
          turn, report.calibration.platform_from_sensor,
          report.calibration.optics_differ ? report.calibration.optics : std::nullopt);
    }
    return report;
  } catch (const Stopped&) {
    return std::nullopt;
  }
}

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
                    .configured_pose = scan.platform_from_sensor,
                    .configured_lasers = scan.laser->lasers,
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
  fs::create_directories(folder.path());
  Scan scan = scan_of_lasers(rig, settings);
  scan.sensor_name = rig.camera().name();
  scan.sensor_serial = rig.camera().serial();
  for (const std::int64_t position :
       stop_positions(turntable.position(), steps, settings.snapshots)) {
    const Stop at{.index = static_cast<int>(scan.shots.size()), .position = position};
    const double angle = radians_from_degrees(angle_deg_at(position, steps));
    if (!take_stop(rig, at, angle, folder.path(), scan, stop, observer)) {
      return std::nullopt;
    }
    observer.on_progress(Phase::capturing, static_cast<int>(scan.shots.size()));
  }
  observer.on_progress(Phase::calibrating, settings.snapshots);
  return solve_turn(folder.path(), scan, threads, stop);
} catch (const Stopped&) {
  return std::nullopt;
}

}  // namespace octurn
