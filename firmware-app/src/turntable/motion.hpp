#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace octurn {

/// Full steps of a stepper motor after which its coils carry the same currents again.
inline constexpr int full_steps_per_period = 4;

/// A turntable's motion: constant acceleration from the start speed, and the same deceleration
/// before the end. A step is a microstep of the motor's driver.
struct Motion {
  int steps_per_turn = 800;   // quarter steps of a 1.8 degree motor
  int steps_per_period = 16;  ///< of the coils' currents: four full steps
  double start_steps_per_second = 40;
  double top_steps_per_second = 200;
  double ramp_steps_per_second2 = 150;
  std::chrono::milliseconds settle_time = std::chrono::milliseconds(300);
};

/// The same with the speeds multiplied by a factor, and the acceleration by its square.
Motion at_pace(const Motion& motion, double pace);

/// Whether a pulse came so late that the motor may have lost steps: meanwhile the platform ran on,
/// by an eighth of a period or more. A platform of 0.013 kg m^2 on a motor of 0.2 N m then loses
/// steps now and then (docs/wiring.md).
/// @param late       seconds
/// @param step_time  planned for the step, seconds
bool may_lose_steps(const Motion& motion, double late, double step_time);

/// The trapezoidal speed profile of one move, step by step: constant acceleration up to the top
/// speed or to the middle of a short move, then the same deceleration.
class SpeedProfile {
 public:
  SpeedProfile(const Motion& motion, std::int64_t steps);

  std::int64_t steps_left() const { return steps_left_; }

  /// Advances by one step. @return the duration of that step, seconds
  double next_step();

  /// Shortens the move to its braking distance. @return false if it may end at once
  bool brake();

  /// Reports that the last step took longer than planned. The next steps accelerate from the speed
  /// that it had.
  /// @param step_time  seconds
  void slowed_to(double step_time);

 private:
  double start_;
  double top_;
  double ramp_;
  double speed_;
  std::int64_t steps_left_;
};

/// The duration of a move without late steps, seconds.
double move_time(const Motion& motion, std::int64_t steps);

/// The delay from which a pulse counts as late. A wake-up takes up to 0.1 ms on a Pi. At 800
/// steps/s, whose step takes 1.25 ms, a delay of 0.5 ms costs more than a quarter of the speed.
inline constexpr std::chrono::microseconds late_after(500);

/// Count and longest delay of pulses that were late because the system scheduled their thread late.
struct LatePulses {
  int count = 0;
  std::chrono::steady_clock::duration longest = {};
  bool may_have_lost_steps = false;
};

/// The pulses of one move on the STEP line of an A4988, which steps on a rising edge.
///
/// Each edge is scheduled from the time of the last one, so that a delay is never caught up: pulses
/// too close together lose steps. The motor regains the lost speed along the ramp. A heavy platform
/// runs on meanwhile, and may lose steps, too.
class PulseTrain {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Change {
    bool high = false;
    Time due = {};
  };

  PulseTrain(const Motion& motion, std::int64_t steps, Time start);

  /// The next change of the line; nothing after the last pulse.
  const std::optional<Change>& next() const { return next_; }

  /// Reports that the next change was made. @param time  of the change
  void done(Time time);

  /// Shortens the move to its braking distance. @return false if it may end at once
  bool brake() { return profile_.brake(); }

  const LatePulses& late() const { return late_; }

 private:
  void plan_rise(Time low_since);

  Motion motion_;
  SpeedProfile profile_;
  Time risen_ = {};         // the last rising edge, or the start
  Time planned_rise_ = {};  // the next rising edge, without delays
  std::optional<Change> next_ = {};
  LatePulses late_ = {};
};

}  // namespace octurn
