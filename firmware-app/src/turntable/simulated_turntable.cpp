#include "turntable/simulated_turntable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace octurn {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

/// The course of one move: even acceleration up to the top speed, or to the middle of a short move,
/// and its mirror image down again. Lengths in steps, times in seconds.
class Course {
 public:
  Course(const Motion& motion, int steps)
      : steps_(steps), start_(motion.start_steps_per_second), gain_(motion.ramp_steps_per_second2) {
    const double to_top =
        (motion.top_steps_per_second * motion.top_steps_per_second - start_ * start_) / (2 * gain_);
    ramp_steps_ = std::min(to_top, steps_ / 2);
    top_ = std::sqrt(start_ * start_ + 2 * gain_ * ramp_steps_);
    ramp_time_ = (top_ - start_) / gain_;
    time_ = 2 * ramp_time_ + (steps_ - 2 * ramp_steps_) / top_;
  }

  /// How long the move takes, seconds.
  double time() const { return time_; }

  /// How far it is at a time from its start, steps.
  double at(double time) const {
    if (time >= time_) {
      return steps_;
    }
    if (time > time_ - ramp_time_) {
      return steps_ - ramp(time_ - time);
    }
    return time < ramp_time_ ? ramp(time) : ramp_steps_ + top_ * (time - ramp_time_);
  }

 private:
  double ramp(double time) const { return start_ * time + gain_ * time * time / 2; }

  double steps_;
  double start_;
  double gain_;
  double ramp_steps_ = 0;
  double top_ = 0;
  double ramp_time_ = 0;
  double time_ = 0;
};

}  // namespace

SimulatedTurntable::SimulatedTurntable(std::function<void(double)> turned, double speed,
                                       Motion motion)
    : turned_(std::move(turned)), speed_(speed), motion_(motion) {}

bool SimulatedTurntable::move_to(int position, std::stop_token stop) {
  constexpr auto tick = std::chrono::milliseconds(10);
  const int from = position_;
  const int direction = position < from ? -1 : 1;
  const Course course(motion_, std::abs(position - from));
  const auto begin = steady_clock::now();
  const auto end = begin + real_time(course.time());
  while (position_ != position) {
    const bool stopped = !wait_until(std::min(steady_clock::now() + tick, end), stop);
    const double elapsed = speed_ * duration<double>(steady_clock::now() - begin).count();
    stand_at(from + direction * static_cast<int>(course.at(elapsed)));
    if (stopped) {
      return false;
    }
  }
  stand_at(position);  // also after no move at all
  const double settle_time = duration<double>(motion_.settle_time).count();
  return wait_until(steady_clock::now() + real_time(settle_time), stop);
}

steady_clock::duration SimulatedTurntable::real_time(double seconds) const {
  return std::chrono::ceil<steady_clock::duration>(duration<double>(seconds / speed_));
}

/// @return false if stopped first
bool SimulatedTurntable::wait_until(steady_clock::time_point time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, stop, time, [] { return false; });
  return !stop.stop_requested();
}

void SimulatedTurntable::stand_at(int position) {
  position_ = position;
  turned_(2 * std::numbers::pi * position / motion_.steps_per_turn);
}

}  // namespace octurn
