#include "scan/run_scan.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>
#include <vector>

#include "octurn/depth_png.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "scan/plan.hpp"
#include "scan/stored_scan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Frames older than the end of a move that a sensor may still hand out: a second of them, at 30 Hz.
constexpr int max_stale_frames = 30;

constexpr auto wait_interval = std::chrono::milliseconds(500);

// A sensor that is well sees about as much at every stop: what turns is a part of the picture.
constexpr double min_coverage = 0.6;  // of the readings in the scan's first snapshot

/// Takes frames whose exposure ended after `settled`; none if stopped first.
std::vector<DepthFrame> read_frames(DepthSensor& sensor, int count, Clock::time_point settled,
                                    const std::stop_token& stop, const ScanObserver& observer) {
  std::vector<DepthFrame> frames;
  for (int stale = 0; frames.size() < static_cast<std::size_t>(count);) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return {};
    }
    if (timed->time > settled) {
      observer.on_frame(timed->frame, sensor.intrinsics().depth_unit);
      frames.push_back(std::move(timed->frame));
    } else if (++stale > max_stale_frames) {
      throw Error(ErrorCode::sensor_failed,
                  sensor.name() + ": its frames are older than they may be",
                  "Unplug the sensor, and plug it in again.");
    }
  }
  return frames;
}

/// Stores one more snapshot: first its image, then the scan.json that names it.
void store(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
           const DepthFrame& frame) {
  write_depth_png(folder / shot.file, frame);
  scan.shots.push_back(shot);
  write_scan(folder, scan);
}

/// The angle that a reader of scan.json gets, to the last bit: a model built from the folder later
/// has the same bytes.
double stored_angle(double angle) { return radians_from_degrees(degrees_from_radians(angle)); }

std::ptrdiff_t readings_in(const DepthFrame& frame) {
  return std::ranges::count_if(frame.depth, [](std::uint16_t depth) { return depth > 0; });
}

ReconstructOptions options_for(const Scan& scan, const ScanSettings& settings,
                               const Limits& limits) {
  ReconstructOptions options = reconstruct_options(settings, limits);
  if (!scan.shots.empty()) {
    options.clip = scan.clip;  // which lost nothing by being written in millimetres
  }
  return options;
}

/// One scan on its way, or one more attempt at it.
class Run {
 public:
  Run(const ScanSettings& settings, const Limits& limits, const std::filesystem::path& folder,
      Rig& rig, const std::stop_token& stop, const ScanObserver& observer)
      : settings_(settings),
        folder_(folder),
        rig_(rig),
        stop_(stop),
        observer_(observer),
        scan_(std::filesystem::exists(folder / "scan.json") ? read_scan(folder) : Scan{}),
        reconstruction_(make_reconstructor(options_for(scan_, settings, limits))) {}

  /// @return false if stopped first
  bool take_snapshots();
  std::optional<Model> build();

 private:
  int done() const { return static_cast<int>(scan_.shots.size()); }
  void begin();
  void resume();
  std::optional<DepthFrame> take_depth_image(std::int64_t position);
  void require_coverage(const DepthFrame& frame);
  void wait_for_added();
  template <typename Add>
  void add(Add add_to);

  const ScanSettings& settings_;
  const std::filesystem::path& folder_;
  Rig& rig_;
  const std::stop_token& stop_;
  const ScanObserver& observer_;
  Scan scan_;
  std::ptrdiff_t first_readings_ = 0;  // in the first snapshot
  std::unique_ptr<Reconstructor> reconstruction_;
  std::future<void> adding_;  // at most one: joined before the next begins, and on every way out
};

bool Run::take_snapshots() {
  if (done() == settings_.snapshots) {
    resume();
    return true;
  }
  Turntable& turntable = rig_.turntable();
  if (done() == 0) {
    begin();
  } else {
    resume();
  }
  const int steps = turntable.steps_per_turn();
  for (const std::int64_t position :
       stop_positions(turntable.position(), steps, settings_.snapshots, done())) {
    std::optional<DepthFrame> frame = take_depth_image(position);
    if (!frame) {
      return false;
    }
    require_coverage(*frame);
    const Shot shot{.file = shot_file(done()),
                    .angle = radians_from_degrees(angle_deg_at(position, steps))};
    store(folder_, scan_, shot, *frame);
    add([added = Snapshot{.frame = *std::move(frame),
                          .intrinsics = scan_.intrinsics,
                          .object_from_sensor = object_from_sensor(scan_.platform_from_sensor,
                                                                   stored_angle(shot.angle))},
         this](Reconstructor& reconstruction) { reconstruction.add(added, stop_); });
  }
  return true;
}

/// What all snapshots of a new scan have in common.
void Run::begin() {
  scan_ = {.sensor_name = rig_.sensor().name(),
           .intrinsics = rig_.sensor().intrinsics(),
           .platform_from_sensor = settings_.platform_from_sensor,
           .clip = settings_.clip};
}

/// Adds what was stored before: in the order in which it was taken, and while the platform turns.
void Run::resume() {
  if (done() < settings_.snapshots && rig_.sensor().intrinsics() != scan_.intrinsics) {
    throw Error(ErrorCode::sensor_other,
                "this scan was begun with another sensor: " + scan_.sensor_name,
                "Plug in the one that it was begun with.");
  }
  const SnapshotSource stored = readable_snapshots(folder_, scan_, stop_);
  first_readings_ = readings_in(stored.read(0).frame);
  add([stored, this](Reconstructor& reconstruction) { reconstruction.add(stored, stop_); });
}

/// Turns to a stop, and takes its depth image; nothing if stopped first.
std::optional<DepthFrame> Run::take_depth_image(std::int64_t position) {
  Turntable& turntable = rig_.turntable();
  DepthSensor& sensor = rig_.sensor();
  const double angle_deg = angle_deg_at(position, turntable.steps_per_turn());
  observer_.on_progress(Phase::turning, done());
  observer_.on_turn(angle_deg);
  if (!turntable.move_to(position, stop_)) {
    return std::nullopt;
  }
  observer_.on_progress(Phase::capturing, done());
  sensor.show_angle(radians_from_degrees(angle_deg));
  const int count = settings_.filter == DepthFilter::basic ? 1 : settings_.frames;
  const std::vector<DepthFrame> frames = read_frames(sensor, count, Clock::now(), stop_, observer_);
  return frames.empty() ? std::nullopt : std::optional(merge_frames(frames, settings_.filter));
}

void Run::require_coverage(const DepthFrame& frame) {
  const std::ptrdiff_t readings = readings_in(frame);
  if (done() == 0) {
    first_readings_ = readings;
  }
  if (readings == 0 ||
      static_cast<double>(readings) < min_coverage * static_cast<double>(first_readings_)) {
    throw Error(ErrorCode::sensor_blind,
                scan_.sensor_name + ": has " + std::to_string(readings) +
                    " readings in its picture, and had " + std::to_string(first_readings_) +
                    " at the first stop",
                "Look for something before its lenses, and for sunlight.");
  }
}

void Run::wait_for_added() {
  while (adding_.valid() && adding_.wait_for(wait_interval) != std::future_status::ready) {
    observer_.on_wait();
  }
  if (adding_.valid()) {
    adding_.get();
  }
}

template <typename Add>
void Run::add(Add add_to) {
  wait_for_added();
  adding_ = std::async(std::launch::async, [this, done = done(), add_to = std::move(add_to)] {
    add_to(*reconstruction_);
    if (done < settings_.snapshots && !stop_.stop_requested()) {  // else comes the model itself
      observer_.on_added(*reconstruction_, done);
    }
  });
}

/// Writes the model; where the octree did not fit in memory as a whole, the snapshots are read
/// again for each part.
std::optional<Model> Run::build() {
  observer_.on_progress(Phase::building, done());
  const Clock::time_point captured = Clock::now();
  wait_for_added();
  if (stop_.stop_requested()) {
    return std::nullopt;  // before all was added
  }
  const auto report = write_model(*reconstruction_, readable_snapshots(folder_, scan_, stop_),
                                  folder_ / "Scan.stl", stop_);
  return report ? std::optional(Model{.report = *report, .build_time = Clock::now() - captured})
                : std::nullopt;
}

}  // namespace

std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Rig& rig,
                              const std::stop_token& stop, const ScanObserver& observer) try {
  Run run(settings, limits, folder, rig, stop, observer);
  return run.take_snapshots() ? run.build() : std::nullopt;
} catch (const Stopped&) {
  return std::nullopt;  // while snapshots were added, or the model was made
}

}  // namespace octurn
