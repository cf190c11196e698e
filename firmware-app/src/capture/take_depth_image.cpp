#include "capture/take_depth_image.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <span>
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

constexpr int max_attempts = 4;      // at a stop to which steps are lost
constexpr int max_lost_periods = 4;  // on the way to a stop
constexpr double slower = 0.7;       // the pace after lost steps: half of the torque
constexpr double clear_share = 0.8;  // of every other angle's misfit
// Of the counted angle's misfit, by no turn at all: 0.01 of a platform that stood still, 0.13 of a
// cup that turned.
constexpr double still_share = 0.05;
constexpr double min_period_deg = 1;  // what the images of two stops can tell
constexpr double max_turn_deg = 30;   // between stops: further on, they share too little

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

/// Reads the next frame whose exposure ended after `settled`; returns none if stopped first.
std::optional<TimedFrame> read_frame(DepthSensor& sensor, Clock::time_point settled,
                                     const std::stop_token& stop, const OnFrame& on_frame) {
  for (int stale = 0; stale <= max_stale_frames; ++stale) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return std::nullopt;
    }
    if (timed->time > settled) {
      on_frame(timed->frame);
      return timed;
    }
  }
  throw Error(
      ErrorCode::sensor_failed,
      sensor.name() + ": its frames arrive too late; they are from before the platform stopped",
      "Unplug the sensor, and plug it in again.");
}

/// Reads frames whose exposure ended after `settled`, and more if they all lost the same pixels;
/// returns none if stopped first.
std::vector<TimedFrame> read_frames(DepthSensor& sensor, std::size_t count,
                                    Clock::time_point settled, const std::stop_token& stop,
                                    const OnFrame& on_frame) {
  std::vector<TimedFrame> frames;
  std::vector<std::size_t> lost;  // in all frames
  while (frames.size() < count ||
         (lost.size() > max_lost_pixels && frames.size() < count + max_more_frames)) {
    std::optional<TimedFrame> timed = read_frame(sensor, settled, stop, on_frame);
    if (!timed) {
      return {};
    }
    lost = frames.empty() ? timed->lost : common(lost, timed->lost);
    frames.push_back(*std::move(timed));
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
  for (int i = 0; i < waited; ++i) {
    if (!read_frame(sensor, settled, stop, on_frame)) {
      return {};
    }
  }
  for (;; waited += count) {
    std::vector<DepthFrame> frames = with_lost_pixels_filled(
        read_frames(sensor, static_cast<std::size_t>(count), settled, stop, on_frame));
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

/// The last stop of a scan and the present one.
struct TwoStops {
  const PlatformLook& look;
  const SeenStop& last;
  const DepthFrame& image;
  double turned_deg = 0;  // as counted
  double period_deg = 0;  // of the coils
};

/// The turns that the platform may have made: by up to `max_lost_periods` less or more than
/// counted. The last one is none at all.
std::vector<double> possible_degs(const TwoStops& stops) {
  std::vector<double> degs;
  for (int lag = -max_lost_periods; lag <= max_lost_periods; ++lag) {
    degs.push_back(stops.turned_deg - lag * stops.period_deg);
  }
  degs.push_back(0);
  return degs;
}

/// How many periods the platform lags behind its count since the last stop, by the misfits of the
/// possible turns: 0 unless one explains the images clearly better than all others. Those of an
/// object of revolution fit no turn best, too, but not as well as those of a platform that stood
/// still.
std::int64_t clear_lag(std::span<const double> misfits) {
  if (misfits.empty()) {
    return 0;
  }
  const double counted = misfits[max_lost_periods];
  const double still = misfits.back();
  const auto lags = misfits.first(misfits.size() - 1);
  const auto best = std::ranges::min_element(lags);
  // Of no turn and every other lag: all but the best itself.
  const auto worse =
      std::ranges::count_if(misfits, [&](double misfit) { return *best < clear_share * misfit; });
  const bool is_moving = worse + 1 == std::ssize(misfits);
  const bool is_still = still < still_share * counted && *best < clear_share * counted;
  return is_moving || is_still ? std::distance(lags.begin(), best) - max_lost_periods : 0;
}

/// Whether the images may show lost steps. A wrong pose alone makes it seem so, too.
bool seem_to_slip(const TwoStops& stops) {
  return stops.period_deg >= min_period_deg && std::abs(stops.turned_deg) <= max_turn_deg &&
         clear_lag(misfits_at(stops.look, stops.last.image, stops.image, possible_degs(stops))) !=
             0;
}

/// Whether a stop has to be taken again, as the platform lost steps on the way to it. The position
/// is then corrected, and the next moves are slower.
bool has_slipped(Rig& rig, const PlatformLook& look, const DepthFrame& image) {
  Turntable& turntable = rig.turntable();
  const SeenStop& last = rig.seen_stop();
  if (last.image.depth.empty() || !rig.can_lose_steps()) {
    return false;
  }
  const double deg_per_step = 360.0 / turntable.steps_per_turn();
  const TwoStops stops{
      .look = look,
      .last = last,
      .image = image,
      .turned_deg = static_cast<double>(turntable.position() - last.position) * deg_per_step,
      .period_deg = turntable.steps_per_period() * deg_per_step};
  if (!turntable.may_have_lost_steps() && !seem_to_slip(stops)) {
    return false;
  }
  const std::int64_t periods = clear_lag(
      misfits_about_any_axis(stops.look, stops.last.image, stops.image, possible_degs(stops)));
  if (periods == 0) {
    return false;
  }
  const std::int64_t steps = periods * turntable.steps_per_period();
  log::warning("turntable", "the motor lost " + std::to_string(steps) +
                                " steps, as the picture shows: the stop is taken again, more "
                                "slowly");
  turntable.set_position(turntable.position() - steps);
  rig.set_pace(slower * rig.pace());
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
    if (has_slipped(rig, look, image)) {
      observer.on_slip();
      if (attempt == max_attempts) {
        throw Error(ErrorCode::turntable_failed,
                    "the motor loses steps on the way to stop " + std::to_string(at.index + 1) +
                        ", however slowly it turns",
                    "Give the motor more current, or make the platform lighter.",
                    {{"stop", at.index + 1.0}});
      }
      continue;
    }
    rig.seen_stop() = {.image = image, .position = at.position};
    return image;
  }
}

}  // namespace octurn
