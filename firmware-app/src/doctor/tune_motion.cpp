#include "doctor/tune_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "capture/seen_rotation.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

// Each asks for half or twice the torque of the one before it.
constexpr std::array slower{std::numbers::sqrt2 / 2, 0.5, std::numbers::sqrt2 / 4, 0.25};
constexpr std::array quicker{std::numbers::sqrt2, 2.0, 2 * std::numbers::sqrt2};
constexpr int frames_at_look = 6;
constexpr int moves = 4;
constexpr double move_deg = 10;         // of the platform: 36 stops in a turn
constexpr double apart_deg = 8;         // as in measure_turn: equal angles would be biased to 0
constexpr double range_deg = 32;        // a loss of several periods is seen
constexpr double look_error_deg = 0.9;  // three times that of a comparison

/// Tries paces one after another.
class PaceTrial {
 public:
  PaceTrial(Rig& rig, const PlatformLook& look, double rate, const StepperSettings& settings,
            const std::stop_token& stop)
      : rig_(rig), look_(look), rate_(rate), stop_(stop) {
    constexpr double full_steps_per_period = 4;
    const double period_deg =
        360 * full_steps_per_period / (settings.full_steps * settings.gear_ratio);
    lost_deg_ = std::max(period_deg / 2, look_error_deg);
  }
  ~PaceTrial() { rig_.turntable().set_pace(1); }
  PaceTrial(const PaceTrial&) = delete;
  PaceTrial& operator=(const PaceTrial&) = delete;

  /// Whether moves at that pace lose steps.
  bool loses(double pace);

 private:
  DepthFrame look_after(double deg);
  bool is_short(const DepthFrame& from, const DepthFrame& to, double expected_deg) const;

  Rig& rig_;
  const PlatformLook& look_;
  double rate_;
  const std::stop_token& stop_;
  double lost_deg_;
};

/// Turns the platform on by an angle, and takes a frame. @param deg  of the platform
DepthFrame PaceTrial::look_after(double deg) {
  Turntable& turntable = rig_.turntable();
  const double steps = deg / std::abs(rate_) / 360 * turntable.steps_per_turn();
  if (!turntable.move_to(turntable.position() + std::llround(steps), stop_)) {
    throw Stopped{};
  }
  const std::vector<DepthFrame> frames =
      read_still_frames(rig_, look_, frames_at_look, stop_, [](const DepthFrame&) {});
  if (frames.empty()) {
    throw Stopped{};
  }
  return merge_frames(frames, DepthFilter::average);
}

bool PaceTrial::is_short(const DepthFrame& from, const DepthFrame& to, double expected_deg) const {
  const double sign = rate_ < 0 ? -1 : 1;
  const AngleRange range = {.min_deg = sign * expected_deg - range_deg,
                            .max_deg = sign * expected_deg + range_deg};
  const auto seen = seen_rotation(look_, from, to, range);
  if (!seen) {
    throw Error(ErrorCode::sensor_blind,
                "there is no object on the platform whose turn could be seen",
                "Put an object with corners on the middle of the platform, such as a shoe.");
  }
  return std::abs(seen->deg - sign * expected_deg) > lost_deg_;
}

bool PaceTrial::loses(double pace) {
  rig_.turntable().set_pace(pace);
  const DepthFrame first = look_after(move_deg);
  DepthFrame before = first;
  for (int move = 0; move < moves; ++move) {
    DepthFrame now = look_after(move_deg);
    if (is_short(before, now, move_deg)) {
      return true;
    }
    before = std::move(now);
  }
  // A whole turn reaches the top speed.
  return is_short(first, look_after(360 + apart_deg - moves * move_deg), apart_deg);
}

}  // namespace

MotionLimits find_motion_limits(Rig& rig, const PlatformLook& look, double rate,
                                const StepperSettings& settings, const std::stop_token& stop) {
  PaceTrial trial(rig, look, rate, settings, stop);
  MotionLimits limits;
  const auto loses = [&](double pace) {
    const bool does = trial.loses(pace);
    (does ? limits.lost_at : limits.fastest) = pace;
    return does;
  };
  if (loses(1)) {
    std::ranges::find_if_not(slower, loses);
  } else {
    std::ranges::find_if(quicker, loses);
  }
  return limits;
}

double pace_with_margin(double fastest) { return fastest / std::numbers::sqrt2; }

}  // namespace octurn
