#include "capture/take_depth_image.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "capture/plan.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Maximum number of buffered frames from before the end of a move: a second of them, at 30 Hz.
constexpr int max_stale_frames = 30;

/// Reads frames whose exposure ended after `settled`; returns none if stopped first.
std::vector<DepthFrame> read_frames(DepthSensor& sensor, int count, Clock::time_point settled,
                                    const std::stop_token& stop, const ScanObserver& observer) {
  std::vector<DepthFrame> frames;
  for (int stale = 0; frames.size() < static_cast<std::size_t>(count);) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return {};
    }
    if (timed->time > settled) {
      observer.on_frame(timed->frame);
      frames.push_back(std::move(timed->frame));
    } else if (++stale > max_stale_frames) {
      throw Error(
          ErrorCode::sensor_failed,
          sensor.name() + ": its frames arrive too late; they are from before the platform stopped",
          "Unplug the sensor, and plug it in again.");
    }
  }
  return frames;
}

}  // namespace

bool turn_to(Rig& rig, const Stop& at, const std::stop_token& stop, const ScanObserver& observer) {
  Turntable& turntable = rig.turntable();
  observer.on_progress(Phase::turning, at.index);
  observer.on_turn(angle_deg_at(at.position, turntable.steps_per_turn()));
  if (!turntable.move_to(at.position, stop)) {
    return false;
  }
  observer.on_progress(Phase::capturing, at.index);
  return true;
}

std::optional<DepthFrame> take_depth_image(Rig& rig, const Stop& at, const ScanSettings& settings,
                                           const std::stop_token& stop,
                                           const ScanObserver& observer) {
  rig.turntable();  // opened first: its errors come before the sensor's
  DepthSensor& sensor = rig.sensor();
  if (!turn_to(rig, at, stop, observer)) {
    return std::nullopt;
  }
  sensor.show_angle(radians_from_degrees(rig.platform_angle_deg()));
  const int count = settings.filter == DepthFilter::basic ? 1 : settings.frames;
  const std::vector<DepthFrame> frames = read_frames(sensor, count, Clock::now(), stop, observer);
  return frames.empty() ? std::nullopt : std::optional(merge_frames(frames, settings.filter));
}

}  // namespace octurn
