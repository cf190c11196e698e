#include "turntable/stepper.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "rig/interruptible_sleep.hpp"
#include "turntable/gpio_lines.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// When its current is switched on, the rotor jumps by up to two full steps and swings.
constexpr auto grip_time = 100ms;

}  // namespace

std::vector<std::int64_t> plan_moves(std::int64_t target, const BacklashState& from,
                                     int take_up_steps) {
  if (take_up_steps == 0 || (target >= from.position && from.backlash_taken_up)) {
    return {target};
  }
  return {std::min(target, from.position) - take_up_steps, target};
}

Stepper::Stepper(const StepperSettings& settings, SetLine set_line, std::int64_t position)
    : settings_(settings),
      motion_(to_motion(settings)),
      set_line_(std::move(set_line)),
      position_(position),
      worker_([this](const std::stop_token& end) { work(end); }) {}

bool Stepper::move_to(std::int64_t position, std::stop_token stop) {
  if (stop.stop_requested()) {
    return false;
  }
  Order order{.target = position, .stop = std::move(stop)};
  {
    std::unique_lock lock(mutex_);
    order_ = &order;
    wake_.notify_all();
    wake_.wait(lock, [&] { return order.done; });  // a stop request brakes first
  }
  if (order.failure) {
    throw to_error(*order.failure);
  }
  return order.arrived && sleep_for(order.stop, motion_.settle_time);
}

void Stepper::set_pace(double pace) {
  const std::lock_guard lock(mutex_);
  motion_ = at_pace(to_motion(settings_), pace);
}

void Stepper::release() {
  const std::lock_guard lock(mutex_);
  switch_off();
}

LatePulses Stepper::late() const {
  const std::lock_guard lock(mutex_);
  return late_;
}

void Stepper::work(const std::stop_token& end) {
  if (const int failure = ask_for_punctual_wake_ups(); failure != 0) {
    log::info("turntable", "no real-time priority (" + std::generic_category().message(failure) +
                               "): on a busy machine the platform turns more slowly");
  }
  std::unique_lock lock(mutex_);
  while (true) {
    const bool ordered =
        wake_.wait_for(lock, end, settings_.idle_release, [this] { return order_ != nullptr; });
    if (ordered) {
      carry_out(*std::exchange(order_, nullptr));
      wake_.notify_all();
      continue;
    }
    try {
      switch_off();
    } catch (const Error& error) {
      log::error("turntable", error.what());
    }
    if (end.stop_requested()) {
      return;
    }
  }
}

void Stepper::carry_out(Order& order) {
  may_have_lost_steps_ = false;
  try {
    switch_on(order.stop);
    order.arrived = true;
    const BacklashState from{.position = position_, .backlash_taken_up = backlash_taken_up_};
    for (const std::int64_t position : plan_moves(order.target, from, settings_.take_up_steps)) {
      order.arrived = order.arrived && turn_to(position, order.stop);
    }
  } catch (...) {
    order.failure = current_failure();
  }
  order.done = true;
}

/// @return false if a stop was requested first
bool Stepper::turn_to(std::int64_t position, const std::stop_token& stop) {
  const std::int64_t steps = std::abs(position - position_);
  if (steps == 0) {
    return !stop.stop_requested();
  }
  const int direction = position < position_ ? -1 : 1;
  backlash_taken_up_ = direction > 0;
  set_line_(Line::direction, (direction > 0) != settings_.reversed);
  PulseTrain train(motion_, steps, Clock::now());
  std::int64_t made = 0;
  while (const auto change = train.next()) {
    std::this_thread::sleep_until(change->due);
    // Pulses that end at once would leave a heavy platform turning.
    if (change->high && stop.stop_requested() && (made == 0 || !train.brake())) {
      break;
    }
    set_line_(Line::step, change->high);
    train.done(Clock::now());
    if (change->high) {
      position_ += direction;
      ++made;
    }
  }
  may_have_lost_steps_ = may_have_lost_steps_ || train.late().may_have_lost_steps;
  report(train.late(), made);
  return position_ == position;
}

/// Switches the motor on; waits, unless a stop is requested, until it has come to rest.
void Stepper::switch_on(const std::stop_token& stop) {
  if (!is_on_) {
    set_line_(Line::enable, false);
    is_on_ = true;
    sleep_for(stop, grip_time);
  }
}

void Stepper::switch_off() {
  if (is_on_) {
    set_line_(Line::enable, true);
    is_on_ = false;
    backlash_taken_up_ = false;
  }
}

void Stepper::report(const LatePulses& late, std::int64_t pulses) {
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

Stepper::SetLine open_gpio_lines(const StepperSettings& settings) {
  const std::vector<NamedLine> lines = to_gpio_lines(settings);
  // Shared, as a std::function has to be copyable.
  return [lines, chip = std::make_shared<GpioChip>(drive_header(lines))](Stepper::Line line,
                                                                         bool high) {
    const auto index = static_cast<std::size_t>(line);
    try {
      chip->set(index, high);
    } catch (const std::system_error& error) {
      throw Error(ErrorCode::turntable_failed,
                  "line " + lines[index].name + " cannot be set: " + error.what(),
                  "Start Octurn again.");
    }
  };
}

}  // namespace octurn
