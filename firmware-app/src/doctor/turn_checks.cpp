#include "doctor/turn_checks.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

namespace octurn {
namespace {

using nlohmann::json;

constexpr Check direction{"turn-direction", "Direction"};
constexpr Check whole_turn{"turn-whole", "A whole turn"};
constexpr Check play{"turn-play", "Play of the gears"};
constexpr Check back{"turn-return", "Return"};
constexpr Check stillness{"turn-still", "Standing still"};
constexpr Check motion{"turn-motion", "Speeds"};

constexpr double not_whole_deg = 1.5;  // three times the measurement's error
constexpr double much_play_deg = 0.6;
constexpr double far_off_deg = 0.6;
constexpr double much_take_up = 3;  // times the play that is left
constexpr double much_swing_s = 1;
constexpr double min_platform_speed = 2;  // degrees a second, the settings' smallest
constexpr double power_share = 0.01;      // tolerance of a ratio of microsteps
constexpr double whole_share = 0.003;

/// A turntable at another pace, as long as this lives.
class Paced {
 public:
  Paced(Turntable& turntable, double pace) : turntable_(turntable) { turntable_.set_pace(pace); }
  ~Paced() { turntable_.set_pace(1); }
  Paced(const Paced&) = delete;
  Paced& operator=(const Paced&) = delete;

 private:
  Turntable& turntable_;
};

std::string degrees(double deg) { return rounded(deg, 1) + " degrees"; }

/// Rounds a ratio for octurn.json: to a whole number if it is nearly one, otherwise to three
/// decimals.
double plain_ratio(double ratio) {
  const double whole = std::round(ratio);
  return whole >= 1 && std::abs(ratio - whole) < whole_share * whole
             ? whole
             : std::round(ratio * 1e3) / 1e3;
}

/// The driver's actual microsteps, if they explain a turn of `share` whole turns.
std::optional<int> other_microsteps(const StepperSettings& settings, double share) {
  for (const auto& [other, levels] : microsteppings(settings.driver)) {
    const double explained = static_cast<double>(settings.microsteps) / other;
    if (other != settings.microsteps && std::abs(share / explained - 1) < power_share) {
      return other;
    }
  }
  return std::nullopt;
}

TurnFinding check_direction(double turn_deg, const StepperSettings& settings) {
  if (turn_deg > 0) {
    return {.finding = direction.ok("counter-clockwise, seen from above, as it has to be")};
  }
  return {.finding = direction.fault("clockwise, seen from above",
                                     std::string("Set reversed to ") +
                                         (settings.reversed ? "false" : "true") +
                                         ", or swap the wires of one coil."),
          .set = {{"reversed", !settings.reversed}}};
}

TurnFinding check_whole_turn(double turn_deg, const StepperSettings& settings) {
  const double share = std::abs(turn_deg) / 360;
  const std::string measured = "came out as " + degrees(std::abs(turn_deg));
  if (std::abs(std::abs(turn_deg) - 360) <= not_whole_deg) {
    return {.finding = whole_turn.ok(measured)};
  }
  const double ratio = plain_ratio(settings.gear_ratio / share);
  if (const auto microsteps = other_microsteps(settings, share)) {
    return {
        .finding = whole_turn.fault(
            measured, "Set microsteps to " + std::to_string(*microsteps) +
                          ": the levels at the driver say so. Or, if they do not, gear_ratio to " +
                          rounded(ratio, 3) + "."),
        .set = {{"microsteps", *microsteps}}};
  }
  return {.finding = whole_turn.fault(measured, "Set gear_ratio to " + rounded(ratio, 3) + "."),
          .set = {{"gear_ratio", ratio}}};
}

TurnFinding check_play(const TurnMeasurement& turn, const StepperSettings& settings) {
  const std::string measured = degrees(turn.play_deg) + " after a move backwards";
  if (turn.play_deg <= much_play_deg) {
    return {.finding = play.ok(measured)};
  }
  // 1.5 times the backlash that remains with the steps in force.
  const double seen_steps =
      turn.play_deg / std::abs(turn.turn_deg) * to_motion(settings).steps_per_turn;
  if (settings.take_up_steps > much_take_up * seen_steps) {
    return {.finding = play.warning(
                measured,
                "take_up_steps are far more than this, and do not help: look for a loose hub, and "
                "an object that slides.")};
  }
  const int steps = settings.take_up_steps + static_cast<int>(std::ceil(1.5 * seen_steps));
  return {.finding = play.warning(measured, "Set take_up_steps to " + std::to_string(steps) + "."),
          .set = {{"take_up_steps", steps}}};
}

bool loses_steps(const TurnMeasurement& turn) { return std::abs(turn.return_deg) > far_off_deg; }

TurnFinding check_return(const TurnMeasurement& turn) {
  const std::string measured = degrees(std::abs(turn.return_deg)) + " from where it began";
  return {.finding = loses_steps(turn)
                         ? back.fault(measured,
                                      "The motor loses steps: lower start_speed_deg_per_s and "
                                      "acceleration_deg_per_s2, give it more current, and see that "
                                      "nothing rubs.")
                         : back.ok(measured)};
}

TurnFinding check_stillness(const TurnMeasurement& turn, const StepperSettings& settings) {
  const double swing =
      std::chrono::duration<double>(settings.settle_time).count() + turn.swings_for_s;
  if (turn.swings_for_s == 0) {
    return {.finding = stillness.ok("stands within " + rounded(swing, 1) + " s of a move")};
  }
  const std::string measured = "swings for " + rounded(swing, 1) + " s after a move";
  return {.finding =
              swing > much_swing_s
                  ? stillness.warning(measured,
                                      "Scans wait that long at each stop. Drive the platform "
                                      "by a gear or a belt of 3:1 to 5:1, or make it lighter.")
                  : stillness.ok(measured)};
}

}  // namespace

std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings) {
  if (turn.turn_deg == 0) {
    return {{.finding = whole_turn.fault(
                 "the platform stands still",
                 "Look for the motor's supply, the wires of its coils, and STEP and ENABLE of the "
                 "driver.")}};
  }
  std::vector<TurnFinding> findings = {check_direction(turn.turn_deg, settings)};
  // Lost steps make a turn short and a move backwards, too: neither gear nor play is to blame.
  if (loses_steps(turn)) {
    findings.push_back({.finding = whole_turn.unknown("the motor loses steps")});
    findings.push_back({.finding = play.unknown("the motor loses steps")});
  } else {
    findings.push_back(check_whole_turn(turn.turn_deg, settings));
    findings.push_back(check_play(turn, settings));
  }
  findings.push_back(check_return(turn));
  findings.push_back(check_stillness(turn, settings));
  return findings;
}

bool is_whole_turn(const TurnMeasurement& turn) {
  return std::abs(std::abs(turn.turn_deg) - 360) <= not_whole_deg && !loses_steps(turn);
}

TurnFinding check_motion(const MotionLimits& limits, const StepperSettings& settings) {
  if (!limits.fastest) {
    return {
        .finding = motion.fault(
            "the motor loses steps even at a quarter of the speeds",
            "Give it all of its rated current, or a stronger motor, drive the platform by a gear "
            "or a belt of 3:1 to 5:1, or make platform and object lighter.")};
  }
  const double pace = pace_with_margin(*limits.fastest);
  const double speed = settings.speed_deg_per_second * pace;
  const double start = settings.start_speed_deg_per_second * pace;
  const double acceleration = settings.acceleration_deg_per_second2 * pace * pace;
  const std::string found =
      "no step is lost up to " + rounded(*limits.fastest, 2) + " times the speeds";
  if (!limits.lost_at) {
    return {.finding = motion.ok(found)};
  }
  const nlohmann::json set = {{"speed_deg_per_s", std::max(speed, min_platform_speed)},
                              {"start_speed_deg_per_s", std::max(start, min_platform_speed)},
                              {"acceleration_deg_per_s2", std::max(acceleration, 1.0)}};
  // With a margin of torque of two at the configured speeds, they may stay.
  if (pace >= 1) {
    return {.finding = motion.ok(found)};
  }
  return {.finding = motion.warning(found, "Set speed_deg_per_s to " + rounded(speed, 1) +
                                               ", start_speed_deg_per_s to " + rounded(start, 1) +
                                               " and acceleration_deg_per_s2 to " +
                                               rounded(acceleration, 1) + "."),
          .set = set};
}

std::vector<TurnFinding> test_turn(Rig& rig, const StepperSettings& settings,
                                   const Eigen::Isometry3d& platform_from_sensor, const Box& clip,
                                   const std::stop_token& stop,
                                   const std::function<void(double done)>& on_progress) {
  constexpr double gentle = 0.5;
  constexpr double share_of_turn = 0.6;  // of the time
  const Paced paced(rig.turntable(), gentle);
  const TurnMeasurement turn =
      measure_turn(rig, platform_from_sensor, clip, stop,
                   [&](double done) { on_progress(share_of_turn * done); });
  std::vector<TurnFinding> findings = check_turn(turn, settings);
  if (is_whole_turn(turn)) {
    const PlatformLook look{.intrinsics = rig.sensor().intrinsics(),
                            .platform_from_sensor = platform_from_sensor,
                            .clip = clip};
    findings.push_back(
        check_motion(find_motion_limits(rig, look, turn.turn_deg / 360, settings, stop), settings));
  }
  return findings;
}

}  // namespace octurn
