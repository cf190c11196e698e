#include "capture/take_depth_image.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
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

// More frames than these are not taken for pixels that were lost on the way in all frames.
constexpr std::size_t max_more_frames = 10;
// Such pixels that a depth image may have: a packet of a Kinect's frame has four times as many.
constexpr std::size_t max_lost_pixels = 300;

/// Pixels, in order, that both have.
std::vector<std::size_t> common(const std::vector<std::size_t>& one,
                                const std::vector<std::size_t>& other) {
  std::vector<std::size_t> both;
  std::ranges::set_intersection(one, other, std::back_inserter(both));
  return both;
}

/// Reads frames whose exposure ended after `settled`, and more if they all lost the same pixels;
/// returns none if stopped first.
std::vector<TimedFrame> read_frames(DepthSensor& sensor, std::size_t count,
                                    Clock::time_point settled, const std::stop_token& stop,
                                    const ScanObserver& observer) {
  std::vector<TimedFrame> frames;
  std::vector<std::size_t> lost;  // in all frames
  for (int stale = 0; frames.size() < count ||
                      (lost.size() > max_lost_pixels && frames.size() < count + max_more_frames);) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return {};
    }
    if (timed->time > settled) {
      observer.on_frame(timed->frame);
      lost = frames.empty() ? timed->lost : common(lost, timed->lost);
      frames.push_back(*std::move(timed));
    } else if (++stale > max_stale_frames) {
      throw Error(
          ErrorCode::sensor_failed,
          sensor.name() + ": its frames arrive too late; they are from before the platform stopped",
          "Unplug the sensor, and plug it in again.");
    }
  }
  return frames;
}

/// Gives each pixel that a frame lost on the way the reading of the next frame that did not lose
/// it: the scene stands still. No filter then takes a lost pixel for one without a reading.
std::vector<DepthFrame> with_lost_pixels_filled(std::vector<TimedFrame> frames) {
  std::vector<DepthFrame> filled;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<std::size_t> missing = frames[i].lost;
    DepthFrame& frame = filled.emplace_back(frames[i].frame);
    for (std::size_t step = 1; step < frames.size() && !missing.empty(); ++step) {
      const TimedFrame& other = frames[(i + step) % frames.size()];
      std::vector<std::size_t> left = common(missing, other.lost);
      std::vector<std::size_t> found;
      std::ranges::set_difference(missing, left, std::back_inserter(found));
      for (const std::size_t pixel : found) {
        frame.depth[pixel] = other.frame.depth[pixel];
      }
      missing = std::move(left);
    }
  }
  return filled;
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
  std::vector<TimedFrame> frames =
      read_frames(sensor, static_cast<std::size_t>(count), Clock::now(), stop, observer);
  return frames.empty() ? std::nullopt
                        : std::optional(merge_frames(with_lost_pixels_filled(std::move(frames)),
                                                     settings.filter));
}

}  // namespace octurn
