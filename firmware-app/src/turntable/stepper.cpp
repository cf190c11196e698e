#include "turntable/stepper.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// When its current comes on, the rotor jumps by up to two full steps and swings.
constexpr auto grip_time = 100ms;

/// Has this thread's pulses come in time, as far as the system allows it.
void be_punctual() {
  const int failure = ask_for_real_time_priority();
  if (failure == 0) {
    return;
  }
  ::prctl(PR_SET_TIMERSLACK,
          1UL);  // without real-time priority, wake-ups are 50 us late to save power
  log::info("turntable", "no real-time priority (" + std::generic_category().message(failure) +
                             "): on a busy machine the platform turns more slowly");
}

}  // namespace

std::vector<int> way_to(int target, const Standing& from, int take_up_steps) {
  if (take_up_steps == 0 || (target >= from.position && from.play_taken_up)) {
    return {target};
  }
  return {std::min(target, from.position) - take_up_steps, target};
}

Stepper::Stepper(const StepperSettings& settings, SetLine set_line, int position)
    : settings_(settings),
      motion_(motion_of(settings)),
      set_line_(std::move(set_line)),
      position_(position),
      worker_([this](const std::stop_token& end) { work(end); }) {}

bool Stepper::move_to(int position, std::stop_token stop) {
  if (stop.stop_requested()) {
    return false;
  }
  Order order{.target = position, .stop = std::move(stop)};
  std::unique_lock lock(mutex_);
  order_ = &order;
  wake_.notify_all();
  wake_.wait(lock, [&] { return order.done; });  // within a step of a stop request
  if (order.failure) {
    std::rethrow_exception(order.failure);
  }
  if (order.arrived) {
    wake_.wait_for(lock, order.stop, motion_.settle_time, [] { return false; });
  }
  return order.arrived && !order.stop.stop_requested();
}

void Stepper::release() {
  const std::lock_guard lock(mutex_);
  let_go();
}

LatePulses Stepper::late() const {
  const std::lock_guard lock(mutex_);
  return late_;
}

void Stepper::work(const std::stop_token& end) {
  be_punctual();
  std::unique_lock lock(mutex_);
  while (true) {
    const bool ordered =
        wake_.wait_for(lock, end, settings_.idle_release, [this] { return order_ != nullptr; });
    if (ordered) {
      carry_out(*std::exchange(order_, nullptr), lock);
      wake_.notify_all();
      continue;
    }
    try {
      let_go();
    } catch (const Error& error) {
      log::error("turntable", error.what());
    }
    if (end.stop_requested()) {
      return;
    }
  }
}

void Stepper::carry_out(Order& order, std::unique_lock<std::mutex>& lock) {
  try {
    hold(lock, order.stop);
    order.arrived = true;
    const Standing from{.position = position_, .play_taken_up = play_taken_up_};
    for (const int position : way_to(order.target, from, settings_.take_up_steps)) {
      order.arrived = order.arrived && turn_to(position, order.stop);
    }
  } catch (...) {
    order.failure = std::current_exception();
  }
  order.done = true;
}

/// @return false if stopped first
bool Stepper::turn_to(int position, const std::stop_token& stop) {
  const int steps = std::abs(position - position_);
  if (steps == 0) {
    return !stop.stop_requested();
  }
  const int direction = position < position_ ? -1 : 1;
  play_taken_up_ = direction > 0;
  set_line_(Line::direction, (direction > 0) != settings_.reversed);
  PulseTrain train(motion_, steps, Clock::now());
  int made = 0;
  while (const auto change = train.next()) {
    std::this_thread::sleep_until(change->due);
    if (change->high && stop.stop_requested()) {
      break;
    }
    set_line_(Line::step, change->high);
    train.done(Clock::now());
    if (change->high) {
      position_ += direction;
      ++made;
    }
  }
  report(train.late(), made);
  return position_ == position;
}

/// Switches the motor on; waits, unless stopped, until it has come to rest.
void Stepper::hold(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
  if (!held_) {
    set_line_(Line::enable, false);
    held_ = true;
    wake_.wait_for(lock, stop, grip_time, [] { return false; });
  }
}

void Stepper::let_go() {
  if (held_) {
    set_line_(Line::enable, true);
    held_ = false;
    play_taken_up_ = false;
  }
}

void Stepper::report(const LatePulses& late, int pulses) {
  if (late.count == 0) {
    return;
  }
  late_.count += late.count;
  late_.longest = std::max(late_.longest, late.longest);
  const auto longest = std::chrono::ceil<std::chrono::milliseconds>(late.longest);
  log::warning("turntable", std::to_string(late.count) + " of " + std::to_string(pulses) +
                                " pulses late, by " + std::to_string(longest.count()) +
                                " ms at most");
}

}  // namespace octurn
