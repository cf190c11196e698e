#include "turntable/loaded_motor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace octurn {
namespace {

constexpr double time_step = 1e-4;  // a bare rotor swings 100 times a second
constexpr int full_steps_per_period = 4;

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

}  // namespace octurn
