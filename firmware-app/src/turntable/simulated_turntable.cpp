#include "turntable/simulated_turntable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "rig/interruptible_sleep.hpp"

namespace octurn {

using std::chrono::duration;
using std::chrono::steady_clock;

namespace {

constexpr double time_step = 1e-4;  // a bare rotor swings 100 times a second

constexpr double tick_time = 0.01;  // real seconds

}  // namespace

LoadedMotor::LoadedMotor(const PlatformLoad& load, double angle)
    : period_(2 * std::numbers::pi * full_steps_per_period / (load.full_steps * load.gear_ratio)),
      torque_(load.holding_torque * load.gear_ratio),
      inertia_(load.inertia + load.rotor_inertia * load.gear_ratio * load.gear_ratio),
      friction_(load.friction),
      damping_(load.damping),
      field_(angle),
      angle_(angle) {}

void LoadedMotor::advance(double seconds) {
  for (owed_ += seconds; owed_ >= time_step; owed_ -= time_step) {
    const double torque =
        torque_ * std::sin(2 * std::numbers::pi / period_ * (field_ - angle_)) - damping_ * speed_;
    const double pushed = speed_ + torque / inertia_ * time_step;
    // Friction takes speed away, and never turns it round: it holds what the torque cannot move.
    const double slowed = std::max(0.0, std::abs(pushed) - friction_ / inertia_ * time_step);
    speed_ = std::copysign(slowed, pushed);
    angle_ += speed_ * time_step;
  }
}

/// The pulses of a move. Times are simulated seconds since its beginning.
struct SimulatedTurntable::Move {
  SpeedProfile profile;
  int direction = 1;
  double now = 0;
  double next_pulse = 0;
  double end = 0;
  Late late = {};
  std::int64_t planned = 0;  // pulses
  bool is_over = false;

  /// @return false if it may end at once
  bool brake() {
    const bool goes_on = now > 0 && profile.brake();
    plan_end();
    return goes_on;
  }

  void plan_end() {
    end = next_pulse;
    for (SpeedProfile rest = profile; rest.steps_left() > 0;) {
      end += rest.next_step();
    }
  }
};

SimulatedTurntable::SimulatedTurntable(std::function<void(double)> turned, double speed,
                                       Motion motion, std::int64_t position,
                                       const std::optional<PlatformLoad>& load)
    : turned_(std::move(turned)),
      speed_(speed),
      configured_(motion),
      motion_(motion),
      position_(position) {
  if (load) {
    platform_.emplace(*load, field());
  }
}

bool SimulatedTurntable::move_to(std::int64_t position, std::stop_token stop) {
  const std::int64_t steps = std::abs(position - position_);
  Move move{.profile = SpeedProfile(motion_, steps),
            .direction = position < position_ ? -1 : 1,
            .end = move_time(motion_, steps),
            .late = late_,
            .is_over = steps == 0};
  may_have_lost_steps_ = false;
  if (steps > 0) {
    plan_pulse(move);
  }
  late_ = {};
  const auto begin = steady_clock::now();
  for (double time = 0; !move.is_over;) {
    if (stop.stop_requested() && !move.brake()) {
      break;
    }
    time = std::min(time + tick_time * speed_, move.end);
    // A stop request brakes, which takes its time.
    if (!sleep_until(stop, begin + real_time(time))) {
      if (!move.brake()) {
        break;
      }
      sleep_until({}, begin + real_time(time));
    }
    make_pulses(move, time);
    turned_(angle());
  }
  turned_(angle());  // also if there was nothing to move
  return settle(stop) && position_ == position;
}

void SimulatedTurntable::swing(duration<double> time) {
  if (platform_ && !platform_->is_at_rest()) {
    platform_->advance(time.count());
    turned_(angle());
  }
}

double SimulatedTurntable::angle() const { return platform_ ? platform_->angle() : field(); }

double SimulatedTurntable::field() const {
  return 2 * std::numbers::pi * static_cast<double>(base_ + position_) / motion_.steps_per_turn;
}

void SimulatedTurntable::plan_pulse(Move& move) {
  const double step_time = move.profile.next_step();
  move.next_pulse += step_time;
  if (++move.planned == move.late.pulse) {
    move.next_pulse += move.late.by;
    move.profile.slowed_to(step_time + move.late.by);
    move.plan_end();
    ++late_pulses_;
    may_have_lost_steps_ = may_lose_steps(motion_, move.late.by, step_time);
  }
}

/// @param until  simulated seconds since the beginning of the move
void SimulatedTurntable::make_pulses(Move& move, double until) {
  const auto pass = [&](double time) {
    if (platform_) {
      platform_->advance(time - move.now);
    }
    move.now = time;
  };
  while (!move.is_over && move.next_pulse <= until) {
    pass(move.next_pulse);
    position_ += move.direction;
    if (platform_) {
      platform_->set_field(field());
    }
    move.is_over = move.profile.steps_left() == 0;
    if (!move.is_over) {
      plan_pulse(move);
    }
  }
  pass(until);
}

/// @return false if stopped first
bool SimulatedTurntable::settle(const std::stop_token& stop) {
  const double settling = duration<double>(motion_.settle_time).count();
  const auto begin = steady_clock::now();
  for (double time = 0; time < settling;) {
    const double passed = std::min(tick_time * speed_, settling - time);
    time += passed;
    if (!sleep_until(stop, begin + real_time(time))) {
      return false;
    }
    swing(duration<double>(passed));
  }
  return !stop.stop_requested();
}

/// @param seconds  simulated
steady_clock::duration SimulatedTurntable::real_time(double seconds) const {
  return std::chrono::ceil<steady_clock::duration>(duration<double>(seconds / speed_));
}

}  // namespace octurn
