#include "turntable/simulated_turntable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace octurn {

using std::chrono::duration;
using std::chrono::steady_clock;

SimulatedTurntable::SimulatedTurntable(std::function<void(double)> turned, double speed,
                                       Motion motion, int position)
    : turned_(std::move(turned)), speed_(speed), motion_(motion), position_(position) {}

bool SimulatedTurntable::move_to(int position, std::stop_token stop) {
  constexpr auto tick = std::chrono::milliseconds(10);
  const int direction = position < position_ ? -1 : 1;
  const int steps = std::abs(position - position_);
  Course course(motion_, steps);
  double arrival =
      steps > 0 ? course.next_step() : 0;  // at the next step, seconds from the beginning
  const auto begin = steady_clock::now();
  const auto end = begin + real_time(move_time(motion_, steps));
  while (position_ != position) {
    const bool stopped = !wait_until(std::min(steady_clock::now() + tick, end), stop);
    const double elapsed = speed_ * duration<double>(steady_clock::now() - begin).count();
    int reached = position_;
    while (reached != position && arrival <= elapsed) {
      reached += direction;
      arrival += course.steps_left() > 0 ? course.next_step() : 0;
    }
    stand_at(reached);
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
