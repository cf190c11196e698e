#include "turntable/simulated_turntable.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "rig/interruptible_sleep.hpp"

namespace octurn {

using std::chrono::duration;
using std::chrono::steady_clock;

SimulatedTurntable::SimulatedTurntable(std::function<void(double)> turned, double speed,
                                       Motion motion, std::int64_t position)
    : turned_(std::move(turned)), speed_(speed), motion_(motion), position_(position) {}

bool SimulatedTurntable::move_to(std::int64_t position, std::stop_token stop) {
  const double tick = 0.01 * speed_;  // simulated seconds in 10 ms
  const int direction = position < position_ ? -1 : 1;
  const std::int64_t steps = std::abs(position - position_);
  SpeedProfile profile(motion_, steps);
  double next_step = steps > 0 ? profile.next_step() : 0;  // simulated seconds since the beginning
  const double end = move_time(motion_, steps);
  const auto begin = steady_clock::now();
  for (double time = tick; position_ != position; time += tick) {
    if (!sleep_until(stop, begin + real_time(std::min(time, end)))) {
      return false;
    }
    std::int64_t reached = position_;
    while (reached != position && next_step <= std::min(time, end)) {
      reached += direction;
      next_step += profile.steps_left() > 0 ? profile.next_step() : 0;
    }
    stand_at(reached);
  }
  stand_at(position);  // reports the angle also if there was nothing to move
  return sleep_for(stop, real_time(duration<double>(motion_.settle_time).count()));
}

/// @param seconds  simulated
steady_clock::duration SimulatedTurntable::real_time(double seconds) const {
  return std::chrono::ceil<steady_clock::duration>(duration<double>(seconds / speed_));
}

void SimulatedTurntable::stand_at(std::int64_t position) {
  position_ = position;
  turned_(2 * std::numbers::pi * static_cast<double>(position) / motion_.steps_per_turn);
}

}  // namespace octurn
