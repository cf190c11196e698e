#include "turntable/motion.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {

SpeedProfile::SpeedProfile(const Motion& motion, std::int64_t steps)
    : start_(std::min(motion.start_steps_per_second, motion.top_steps_per_second)),
      top_(motion.top_steps_per_second),
      ramp_(motion.ramp_steps_per_second2),
      speed_(start_),
      steps_left_(steps) {}

double SpeedProfile::next_step() {
  --steps_left_;
  // v^2 = v0^2 + 2 a s: forwards over one step, and backwards from the end over the steps left.
  const double gained = std::sqrt(speed_ * speed_ + 2 * ramp_);
  const double stoppable =
      std::sqrt(start_ * start_ + 2 * ramp_ * static_cast<double>(steps_left_));
  const double next = std::min({gained, top_, stoppable});
  const double mean = (speed_ + next) / 2;
  speed_ = next;
  return 1 / mean;
}

bool SpeedProfile::brake() {
  if (steps_left_ == 0) {
    return true;  // the last step is being made
  }
  const double distance = std::ceil((speed_ * speed_ - start_ * start_) / (2 * ramp_) - 1e-6);
  steps_left_ = std::min(steps_left_, static_cast<std::int64_t>(distance));
  return steps_left_ > 0;
}

void SpeedProfile::slowed_to(double step_time) {
  speed_ = std::clamp(1 / step_time, start_, speed_);
}

bool may_lose_steps(const Motion& motion, double late, double step_time) {
  return 8 * late > motion.steps_per_period * step_time;
}

Motion at_pace(const Motion& motion, double pace) {
  Motion paced = motion;
  paced.start_steps_per_second *= pace;
  paced.top_steps_per_second *= pace;
  paced.ramp_steps_per_second2 *= pace * pace;
  return paced;
}

double move_time(const Motion& motion, std::int64_t steps) {
  SpeedProfile profile(motion, steps);
  double time = 0;
  while (profile.steps_left() > 0) {
    time += profile.next_step();
  }
  return time;
}

namespace {

using namespace std::chrono_literals;
using std::chrono::duration;
using std::chrono::steady_clock;

// The A4988 needs 1 us (datasheet, figure 1); long wires and level shifters may want more.
constexpr auto shortest_level = 20us;

}  // namespace

PulseTrain::PulseTrain(const Motion& motion, std::int64_t steps, Time start)
    : motion_(motion), profile_(motion, steps), risen_(start) {
  plan_rise(start);
}

void PulseTrain::done(Time time) {
  if (!next_->high) {
    plan_rise(time);
    return;
  }
  const auto delay = time - planned_rise_;
  if (delay > late_after) {
    ++late_.count;
    late_.longest = std::max(late_.longest, delay);
    late_.may_have_lost_steps = late_.may_have_lost_steps ||
                                may_lose_steps(motion_, duration<double>(delay).count(),
                                               duration<double>(planned_rise_ - risen_).count());
    profile_.slowed_to(duration<double>(time - risen_).count());
  }
  risen_ = time;
  next_ = Change{.high = false, .due = time + shortest_level};
}

/// @param low_since  time of the falling edge, or of the start
void PulseTrain::plan_rise(Time low_since) {
  if (profile_.steps_left() == 0) {
    next_.reset();
    return;
  }
  planned_rise_ =
      risen_ + std::chrono::ceil<steady_clock::duration>(duration<double>(profile_.next_step()));
  next_ = Change{.high = true, .due = std::max(planned_rise_, low_since + shortest_level)};
}

}  // namespace octurn
