#pragma once

#include <chrono>
#include <cstdint>

namespace octurn {

/// A turntable's motion: constant acceleration from the start speed, and the same deceleration
/// before the end. A step is a microstep of the motor's driver.
struct Motion {
  int steps_per_turn = 800;  // quarter steps of a 1.8 degree motor
  double start_steps_per_second = 40;
  double top_steps_per_second = 200;
  double ramp_steps_per_second2 = 150;
  std::chrono::milliseconds settle_time = std::chrono::milliseconds(300);
};

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
