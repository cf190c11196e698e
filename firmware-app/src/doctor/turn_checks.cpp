#include "doctor/turn_checks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "capture/seen_rotation.hpp"
#include "capture/take_depth_image.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/median.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int frames_at_look = 6;

// Commanded moves, tried in turn until the platform is seen to move: enough for gears of 1, 4 and
// 12 times the configured gear ratio.
constexpr std::array first_moves_deg{8.0, 30.0, 90.0};
constexpr double seen_move_deg = 10;  // target of each later move, degrees of the platform
constexpr int few_moves = 4;          // the median tolerates two wrong measurements
constexpr int more_moves = 8;         // their median is accurate to some percent
// Search range of the first moves. A platform that turns six times as far as commanded leaves it
// with its first move of 8 degrees, but not with the next, whose size follows from what was seen.
constexpr double widest_deg = 40;
constexpr double expected_deg = 6;  // search range about an expected angle
constexpr double still_deg = 1;     // a first move below it counts as standing still
constexpr double closing_deg = 32;  // search range after a turn: 9 % of it
constexpr double settled_deg = 2;   // a comparison so close does not depend on the pose
constexpr int closing_looks = 3;
constexpr int play_rounds = 3;
constexpr double approach_deg = 15;  // more than the backlash of any gears
// Minimum angle between two compared frames: the sensor's fixed-pattern error is the same in both,
// and biases smaller angles towards 0.
constexpr double apart_deg = 8;
constexpr int looks = 2 * few_moves + more_moves + closing_looks + 3 * play_rounds + 2;

[[noreturn]] void throw_unseen(const std::string& what) {
  throw Error(ErrorCode::sensor_blind, what,
              "Put an object with corners on the middle of the platform, such as a shoe.");
}

AngleRange around(double deg, double half_width_deg) {
  return {.min_deg = deg - half_width_deg, .max_deg = deg + half_width_deg};
}

/// Moves the motor to commanded angles from the starting position, and compares the depth
/// frames ("looks") taken there.
class TurnMeter {
 public:
  TurnMeter(Rig& rig, PlatformLook view, const std::stop_token& stop,
            const std::function<void(double)>& on_progress)
      : rig_(rig),
        view_(std::move(view)),
        stop_(stop),
        on_progress_(on_progress),
        start_(rig.turntable().position()) {}

  TurnMeasurement measure();

 private:
  void move_to(double commanded_deg);
  DepthFrame look();
  DepthFrame look_at(double commanded_deg);
  DepthFrame look_from_below(double commanded_deg, double rate);
  double seen(const DepthFrame& from, const DepthFrame& to, const AngleRange& range);
  double median_rate(int moves, double move_deg, const AngleRange& range);
  double measure_rate();
  double measure_whole(double rate);
  double measure_play(double rate);
  double measure_return(double rate);

  Rig& rig_;
  PlatformLook view_;
  const std::stop_token& stop_;
  const std::function<void(double)>& on_progress_;
  std::int64_t start_;
  double commanded_deg_ = 0;
  DepthFrame first_look_ = {};
  std::vector<double> sharpness_ = {};
  int looks_done_ = 0;
  double swings_for_s_ = 0;  // at most
};

void TurnMeter::move_to(double commanded_deg) {
  Turntable& turntable = rig_.turntable();
  const double steps = commanded_deg / 360 * turntable.steps_per_turn();
  commanded_deg_ = commanded_deg;
  if (!turntable.move_to(start_ + std::llround(steps), stop_)) {
    throw Stopped{};
  }
}

/// Returns the mean of `frames_at_look` frames of the platform at rest.
DepthFrame TurnMeter::look() {
  const std::vector<DepthFrame> frames =
      read_still_frames(rig_, view_, frames_at_look, stop_, [](const DepthFrame&) {});
  if (frames.empty()) {
    throw Stopped{};
  }
  swings_for_s_ = std::max(swings_for_s_, rig_.settling().time().count());
  on_progress_(std::min(1.0, static_cast<double>(++looks_done_) / looks));
  return merge_frames(frames, DepthFilter::average);
}

DepthFrame TurnMeter::look_at(double commanded_deg) {
  move_to(commanded_deg);
  return look();
}

/// Takes a frame at a commanded angle that is approached forwards, so that the backlash is taken
/// up.
DepthFrame TurnMeter::look_from_below(double commanded_deg, double rate) {
  if (commanded_deg <= commanded_deg_) {
    move_to(commanded_deg - approach_deg / std::abs(rate));
  }
  return look_at(commanded_deg);
}

double TurnMeter::seen(const DepthFrame& from, const DepthFrame& to, const AngleRange& range) {
  const auto rotation = seen_rotation(view_, from, to, range);
  if (!rotation) {
    throw_unseen("there is no object on the platform whose turn could be seen");
  }
  sharpness_.push_back(rotation->sharpness);
  return rotation->deg;
}

/// Makes equal moves forwards. @return median rate: degrees of the platform for each commanded
/// degree
double TurnMeter::median_rate(int moves, double move_deg, const AngleRange& range) {
  std::vector<double> rates;
  DepthFrame before = look();
  for (int move = 0; move < moves; ++move) {
    DepthFrame now = look_at(commanded_deg_ + move_deg);
    rates.push_back(seen(before, now, range) / move_deg);
    before = std::move(now);
  }
  return median(std::move(rates));
}

/// Measures the rate with moves that are adapted to a good size.
/// @return the rate; 0 if the platform stands still
double TurnMeter::measure_rate() {
  for (const double move_deg : first_moves_deg) {
    const double first = median_rate(few_moves, move_deg, around(0, widest_deg));
    if (std::abs(first * move_deg) < still_deg) {
      continue;
    }
    const double second =
        median_rate(few_moves, seen_move_deg / std::abs(first), around(0, widest_deg));
    const double sign = second > 0 ? 1 : -1;
    return second == 0 ? 0
                       : median_rate(more_moves, seen_move_deg / std::abs(second),
                                     around(sign * seen_move_deg, expected_deg));
  }
  return 0;
}

/// Moves by a whole turn and `apart_deg`, and corrects the rate by the angle measured to the first
/// frame. @return the rate over that whole turn
double TurnMeter::measure_whole(double rate) {
  const double sign = rate > 0 ? 1 : -1;
  double range_deg = closing_deg;
  for (int count = 0; count < closing_looks; ++count) {
    const double commanded_deg = sign * (360 + apart_deg) / rate;
    const DepthFrame now = look_from_below(commanded_deg, rate);
    const double seen_deg = seen(first_look_, now, around(sign * apart_deg, range_deg));
    rate = (sign * 360 + seen_deg) / commanded_deg;
    if (std::abs(seen_deg - sign * apart_deg) < settled_deg) {
      break;
    }
    range_deg = expected_deg;
  }
  return rate;
}

/// Moves on and back some times, and measures the angle to a position a little further on before
/// and after. @return by how much a move back falls short, degrees: the median, as an inexact pose
/// causes errors of a degree now and then
double TurnMeter::measure_play(double rate) {
  const double there_deg = commanded_deg_;
  const double on_deg = apart_deg / std::abs(rate);
  const AngleRange range = around(0, approach_deg);
  std::vector<double> short_by;
  for (int round = 0; round < play_rounds; ++round) {
    const DepthFrame before = look_from_below(there_deg, rate);
    const DepthFrame further = look_at(there_deg + on_deg);
    move_to(there_deg + approach_deg / std::abs(rate));
    const DepthFrame after = look_at(there_deg);
    short_by.push_back(seen(before, further, range) - seen(after, further, range));
  }
  const double short_deg = median(std::move(short_by));
  return rate > 0 ? short_deg : -short_deg;
}

/// Commands the starting angle again. @return the platform's offset from it, degrees
double TurnMeter::measure_return(double rate) {
  const double on_deg = apart_deg / std::abs(rate);
  const DepthFrame now = look_from_below(on_deg, rate);
  const double off_deg =
      seen(first_look_, now, around(rate * on_deg, approach_deg)) - rate * on_deg;
  move_to(0);
  return off_deg;
}

TurnMeasurement TurnMeter::measure() {
  move_to(-approach_deg);
  first_look_ = look_at(0);
  const double rate = measure_rate();
  if (median(sharpness_) < min_sharpness) {
    throw_unseen("the object on the platform looks the same from all sides");
  }
  if (rate == 0) {
    return {};
  }
  const double whole_rate = measure_whole(rate);
  const double play_deg = measure_play(whole_rate);
  return {.turn_deg = 360 * whole_rate,
          .play_deg = std::max(play_deg, 0.0),
          .return_deg = measure_return(whole_rate),
          .swings_for_s = swings_for_s_};
}

}  // namespace

TurnMeasurement measure_turn(Rig& rig, const Eigen::Isometry3d& platform_from_sensor,
                             const Box& clip, const std::stop_token& stop,
                             const std::function<void(double done)>& on_progress) {
  const PlatformLook view{.intrinsics = rig.sensor().intrinsics(),
                          .platform_from_sensor = platform_from_sensor,
                          .clip = clip};
  return TurnMeter(rig, view, stop, on_progress).measure();
}

namespace {

// Each asks for half or twice the torque of the one before it.
constexpr std::array slower{std::numbers::sqrt2 / 2, 0.5, std::numbers::sqrt2 / 4, 0.25};
constexpr std::array quicker{std::numbers::sqrt2, 2.0, 2 * std::numbers::sqrt2};
constexpr int moves = 4;
constexpr double move_deg = 10;         // of the platform: 36 stops in a turn
constexpr double range_deg = 32;        // a loss of several periods is seen
constexpr double look_error_deg = 0.9;  // three times that of a comparison

/// Tries paces one after another.
class PaceTrial {
 public:
  PaceTrial(Rig& rig, const PlatformLook& look, double rate, const StepperSettings& settings,
            const std::stop_token& stop)
      : rig_(rig), look_(look), rate_(rate), stop_(stop) {
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
  bool is_short(const DepthFrame& from, const DepthFrame& to, double turned_deg) const;

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

bool PaceTrial::is_short(const DepthFrame& from, const DepthFrame& to, double turned_deg) const {
  const double sign = rate_ < 0 ? -1 : 1;
  const AngleRange range = {.min_deg = sign * turned_deg - range_deg,
                            .max_deg = sign * turned_deg + range_deg};
  const auto seen = seen_rotation(look_, from, to, range);
  if (!seen) {
    throw Error(ErrorCode::sensor_blind,
                "there is no object on the platform whose turn could be seen",
                "Put an object with corners on the middle of the platform, such as a shoe.");
  }
  return std::abs(seen->deg - sign * turned_deg) > lost_deg_;
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
                                      "The motor loses steps: lower its start speed and its "
                                      "acceleration, give it more current, and see that nothing "
                                      "rubs.")
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

namespace {

/// Whether a turn came out whole, and no step was lost.
bool is_whole_turn(const TurnMeasurement& turn) {
  return std::abs(std::abs(turn.turn_deg) - 360) <= not_whole_deg && !loses_steps(turn);
}

}  // namespace

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
