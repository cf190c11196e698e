#include "doctor/turn_checks.hpp"

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

constexpr double not_whole_deg = 1.5;  // three times the measurement's error
constexpr double much_play_deg = 0.6;
constexpr double far_off_deg = 0.6;
constexpr double power_share = 0.01;  // tolerance of a ratio of microsteps
constexpr double whole_share = 0.003;

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
  const int steps = settings.take_up_steps + static_cast<int>(std::ceil(1.5 * seen_steps));
  return {.finding = play.warning(measured, "Set take_up_steps to " + std::to_string(steps) + "."),
          .set = {{"take_up_steps", steps}}};
}

TurnFinding check_return(double return_deg) {
  const std::string measured = degrees(std::abs(return_deg)) + " from where it began";
  return {.finding = std::abs(return_deg) <= far_off_deg
                         ? back.ok(measured)
                         : back.fault(measured,
                                      "The motor loses steps: lower start_speed_deg_per_s and "
                                      "acceleration_deg_per_s2, give it more current, and see that "
                                      "nothing rubs.")};
}

}  // namespace

std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings) {
  if (turn.turn_deg == 0) {
    return {{.finding = whole_turn.fault(
                 "the platform stands still",
                 "Look for the motor's supply, the wires of its coils, and STEP and ENABLE of the "
                 "driver.")}};
  }
  return {check_direction(turn.turn_deg, settings), check_whole_turn(turn.turn_deg, settings),
          check_play(turn, settings), check_return(turn.return_deg)};
}

}  // namespace octurn
