#pragma once

#include <chrono>
#include <cstdint>

namespace octurn {

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

}  // namespace octurn
