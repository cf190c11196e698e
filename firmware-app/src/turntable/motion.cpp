#include "turntable/motion.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {

Course::Course(const Motion& motion, int steps)
    : start_(std::min(motion.start_steps_per_second, motion.top_steps_per_second)),
      top_(motion.top_steps_per_second),
      ramp_(motion.ramp_steps_per_second2),
      speed_(start_),
      steps_left_(steps) {}

double Course::next_step() {
  --steps_left_;
  // v^2 = v0^2 + 2 a s, for one step from here and for what is left of the way to the end.
  const double gained = std::sqrt(speed_ * speed_ + 2 * ramp_);
  const double may_still_stop = std::sqrt(start_ * start_ + 2 * ramp_ * steps_left_);
  const double next = std::min({gained, top_, may_still_stop});
  const double mean = (speed_ + next) / 2;
  speed_ = next;
  return 1 / mean;
}

void Course::slowed_to(double step_time) { speed_ = std::clamp(1 / step_time, start_, speed_); }

double move_time(const Motion& motion, int steps) {
  Course course(motion, steps);
  double time = 0;
  while (course.steps_left() > 0) {
    time += course.next_step();
  }
  return time;
}

}  // namespace octurn
