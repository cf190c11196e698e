#include "turntable/pulse_train.hpp"

#include <algorithm>

namespace octurn {
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
