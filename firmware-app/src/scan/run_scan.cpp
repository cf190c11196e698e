#include "scan/run_scan.hpp"

#include <chrono>
#include <future>
#include <utility>
#include <vector>

#include "octurn/platform_pose.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "scan/plan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Frames older than the end of a move that a sensor may still hand out: a second of them, at 30 Hz.
constexpr int most_stale_frames = 30;

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
    } else if (++stale > most_stale_frames) {
      throw Error("sensor-failed", sensor.name() + ": its frames are older than they may be",
                  "Unplug the sensor, plug it in again and start a new scan.");
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

/// Leads out of a model that is no longer wanted.
struct Stopped {};

/// Writes `folder/Scan.stl`; where the octree did not fit in memory as a whole, the snapshots are
/// read again for each part.
std::optional<ModelReport> write_model_unless_stopped(Reconstruction& reconstruction,
                                                      const std::filesystem::path& folder,
                                                      const Scan& scan,
                                                      const std::stop_token& stop) try {
  const SnapshotSource snapshots{.count = scan.shots.size(), .read = [&](std::size_t shot) {
                                   if (stop.stop_requested()) {
                                     throw Stopped{};
                                   }
                                   return read_snapshot(folder, scan, scan.shots[shot]);
                                 }};
  return write_model(reconstruction, snapshots, folder / "Scan.stl", stop);
} catch (const Stopped&) {
  return std::nullopt;
}

}  // namespace

std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Rig& rig,
                              const std::stop_token& stop, const ScanObserver& observer) {
  Turntable& turntable = rig.turntable();
  DepthSensor& sensor = rig.sensor();
  const int steps = turntable.steps_per_turn();
  const int frame_count = settings.filter == DepthFilter::basic ? 1 : settings.frames;
  Scan scan{.sensor_name = sensor.name(),
            .intrinsics = sensor.intrinsics(),
            .platform_from_sensor = settings.platform_from_sensor,
            .clip = settings.clip};
  Reconstruction reconstruction(reconstruct_options(settings, limits));
  std::future<void> adding;  // at most one: joined before the next begins, and on every way out

  int done = 0;
  for (const int position : stop_positions(turntable.position(), steps, settings.snapshots)) {
    observer.on_progress(Phase::turning, done);
    if (!turntable.move_to(position, stop)) {
      return std::nullopt;
    }
    observer.on_progress(Phase::capturing, done);
    const std::vector<DepthFrame> frames =
        read_frames(sensor, frame_count, Clock::now(), stop, observer);
    if (frames.empty()) {
      return std::nullopt;
    }
    const Shot shot{.file = shot_file(done),
                    .angle = radians_from_degrees(angle_deg_at(position, steps))};
    Snapshot snapshot{.frame = merge_frames(frames, settings.filter),
                      .intrinsics = scan.intrinsics,
                      .object_from_sensor = object_from_sensor(settings.platform_from_sensor,
                                                               stored_angle(shot.angle))};
    store(folder, scan, shot, snapshot.frame);
    ++done;
    if (adding.valid()) {
      adding.get();
    }
    adding = std::async(std::launch::async, [&, done, added = std::move(snapshot)] {
      reconstruction.add(added);
      if (done < settings.snapshots) {  // then comes the model itself
        observer.on_added(reconstruction, done);
      }
    });
  }

  observer.on_progress(Phase::building, done);
  const Clock::time_point captured = Clock::now();
  adding.get();
  const auto report = write_model_unless_stopped(reconstruction, folder, scan, stop);
  return report ? std::optional(Model{.report = *report, .build_time = Clock::now() - captured})
                : std::nullopt;
}

}  // namespace octurn
