#include "capture/take_depth_image.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "capture/plan.hpp"
#include "capture/seen_rotation.hpp"
#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Maximum number of buffered frames from before the end of a move: a second of them, at 30 Hz.
constexpr int max_stale_frames = 30;

constexpr int max_attempts = 3;         // at a stop to which steps are lost
constexpr double max_lost_periods = 4;  // by one late pulse

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
                                    const OnFrame& on_frame) {
  std::vector<TimedFrame> frames;
  std::vector<std::size_t> lost;  // in all frames
  for (int stale = 0; frames.size() < count ||
                      (lost.size() > max_lost_pixels && frames.size() < count + max_more_frames);) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return {};
    }
    if (timed->time > settled) {
      on_frame(timed->frame);
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

std::vector<DepthFrame> read_still_frames(Rig& rig, const PlatformLook& look, int count,
                                          const std::stop_token& stop, const OnFrame& on_frame) {
  DepthSensor& sensor = rig.sensor();
  const Clock::time_point settled = Clock::now();
  int waited = rig.settling().frames();
  const auto read = [&](int number) {
    return with_lost_pixels_filled(
        read_frames(sensor, static_cast<std::size_t>(number), settled, stop, on_frame));
  };
  if (waited > 0 && read(waited).empty()) {
    return {};
  }
  for (;; waited += count) {
    std::vector<DepthFrame> frames = read(count);
    const bool is_still = frames.size() < 2 || !is_swinging(look, frames);
    if (!is_still && waited + count <= max_settling_frames) {
      continue;
    }
    if (!is_still) {
      log::warning("turntable", "the platform does not stand still: after " +
                                    std::to_string(waited) +
                                    " frames those of a stop still differ");
    }
    rig.settling().stood_after(waited);
    return frames;
  }
}

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

namespace {

/// How far the platform lags behind its count since the last stop, microsteps: whole periods, as
/// the two stops' images show it. Nothing if they do not.
std::optional<std::int64_t> seen_lag(Rig& rig, const PlatformLook& look, const DepthFrame& image) {
  const Turntable& turntable = rig.turntable();
  const SeenStop& last = rig.seen_stop();
  if (last.image.depth.empty()) {
    return std::nullopt;
  }
  const double deg_per_step = 360.0 / turntable.steps_per_turn();
  const double turned_deg =
      static_cast<double>(turntable.position() - last.position) * deg_per_step;
  const double period_deg = turntable.steps_per_period() * deg_per_step;
  const double range_deg = max_lost_periods * period_deg + 1;
  const auto seen =
      seen_rotation(look, last.image, image, {turned_deg - range_deg, turned_deg + range_deg});
  if (!seen || seen->sharpness < min_sharpness) {
    return std::nullopt;
  }
  return std::llround((turned_deg - seen->deg) / period_deg) * turntable.steps_per_period();
}

/// Whether a stop has to be taken again, as pulses on the way to it were so late that the platform
/// lost steps: the position is then corrected.
bool has_slipped(Rig& rig, const PlatformLook& look, const DepthFrame& image) {
  Turntable& turntable = rig.turntable();
  if (!turntable.may_have_lost_steps()) {
    return false;
  }
  const auto lag = seen_lag(rig, look, image);
  if (!lag || *lag == 0) {
    log::info("turntable", lag ? "late pulses lost no step, as the picture shows"
                               : "late pulses may have lost steps: the picture does not show it");
    return false;
  }
  log::warning("turntable", "late pulses lost " + std::to_string(*lag) +
                                " steps, as the picture shows: the stop is taken again");
  turntable.set_position(turntable.position() - *lag);
  return true;
}

}  // namespace

std::optional<DepthFrame> take_depth_image(Rig& rig, const Stop& at, const ScanSettings& settings,
                                           const std::stop_token& stop,
                                           const ScanObserver& observer) {
  rig.turntable();  // opened first: its errors come before the sensor's
  DepthSensor& sensor = rig.sensor();
  const PlatformLook look{sensor.intrinsics(), settings.platform_from_sensor, settings.clip};
  const int count = settings.filter == DepthFilter::basic ? 1 : settings.frames;
  for (int attempt = 1;; ++attempt) {
    if (!turn_to(rig, at, stop, observer)) {
      return std::nullopt;
    }
    rig.show_platform();
    const std::vector<DepthFrame> frames =
        read_still_frames(rig, look, count, stop, observer.on_frame);
    if (frames.empty()) {
      return std::nullopt;
    }
    DepthFrame image = merge_frames(frames, settings.filter);
    if (attempt < max_attempts && has_slipped(rig, look, image)) {
      continue;
    }
    rig.seen_stop() = {.image = image, .position = at.position};
    return image;
  }
}

}  // namespace octurn
