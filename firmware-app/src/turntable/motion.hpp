#pragma once

#include <chrono>

namespace octurn {

/// How a turntable moves: from rest it gains speed evenly, and loses it again before it stops.
/// Steps are those of the driver: microsteps, unless it makes full ones.
struct Motion {
  int steps_per_turn = 800;             // quarter steps of a 1.8 degree motor
  double start_steps_per_second = 200;  // a stepper can start at once at this speed
  double top_steps_per_second = 800;
  double ramp_steps_per_second2 = 2000;
  std::chrono::milliseconds settle_time = std::chrono::milliseconds(300);
};

/// The speed of one move, from step to step: even acceleration up to the top speed, or to the
/// middle of a short move, and its mirror image down again.
class Course {
 public:
  Course(const Motion& motion, int steps);

  int steps_left() const { return steps_left_; }

  /// Goes one step on. @return how long that step takes, seconds
  double next_step();

  /// The last step took longer than planned, seconds: what it lost of its speed is gained evenly.
  void slowed_to(double step_time);

 private:
  double start_;
  double top_;
  double ramp_;
  double speed_;
  int steps_left_;
};

/// How long a move takes, seconds, if no step is late.
double move_time(const Motion& motion, int steps);

}  // namespace octurn
