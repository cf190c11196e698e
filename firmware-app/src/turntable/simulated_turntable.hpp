#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "turntable/motion.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A platform and the stepper that turns it. The defaults are those of docs/wiring.md: a NEMA 17 of
/// 0.4 N m at half of its current, and a disc of 28 cm of 12 mm birch plywood on its shaft.
struct PlatformLoad {
  double holding_torque = 0.2;    ///< of the motor, N m
  double inertia = 0.005;         ///< of disc and object about the axis, kg m^2
  double friction = 0.02;         ///< of the bearing, N m at the platform
  double damping = 1e-3;          ///< N m s, at the platform
  double gear_ratio = 1;          ///< turns of the motor in one of the platform
  double rotor_inertia = 5.4e-6;  ///< kg m^2, at the motor
  int full_steps = 200;           ///< in a turn of the motor; four of them are a period
};

/// The motion of a platform on its motor's magnetic spring. The rotor follows the field with the
/// torque T sin(N (field - rotor)), N being the periods in a turn. It lags, swings about its rest,
/// and loses whole periods where the torque is too small for what the field asks of it (Acarnley,
/// Stepping Motors, chapter 4). Coulomb friction stops and holds the platform near that rest.
///
/// Angles are the platform's, radians, counter-clockwise. Deterministic, in steps of 0.1 ms.
class LoadedMotor {
 public:
  /// Begins at rest. @param angle  of the field and the platform
  explicit LoadedMotor(const PlatformLoad& load, double angle = 0);

  /// Turns the field. @param angle  where the driver's microstep has it
  void set_field(double angle) { field_ = angle; }

  /// Lets time pass, seconds. A remainder below 0.1 ms is kept for the next call.
  void advance(double seconds);

  double angle() const { return angle_; }

  /// How far the platform is from the field, radians: multiples of a period are lost steps.
  double lag() const { return field_ - angle_; }

  /// The angle of a period of the field, radians at the platform.
  double period() const { return period_; }

  bool is_at_rest() const { return speed_ == 0; }

 private:
  double period_;
  double torque_;   // at the platform
  double inertia_;  // at the platform, of all that turns
  double friction_;
  double damping_;
  double field_;
  double angle_;
  double speed_ = 0;  // radians a second
  double owed_ = 0;   // seconds
};

/// A turntable that moves nothing, but takes a real one's time and reports its angle.
class SimulatedTurntable final : public Turntable {
 public:
  /// @param turned    receives the platform's angle (radians, counter-clockwise seen from above,
  ///                  not wrapped) every 10 ms of a move and of its settling, and at the end of
  ///                  both, on the moving thread. The angles depend on simulated time only: on a
  ///                  busy machine they come later
  /// @param speed     simulated seconds in a real one
  /// @param position  the initial one, microsteps
  /// @param load      platform on the motor; nothing: it follows each pulse at once
  explicit SimulatedTurntable(std::function<void(double)> turned, double speed = 1,
                              Motion motion = {}, std::int64_t position = 0,
                              const std::optional<PlatformLoad>& load = {});

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(std::int64_t position, std::stop_token stop) override;
  void set_pace(double pace) override { motion_ = at_pace(configured_, pace); }
  std::int64_t position() const override { return position_; }
  int late_pulses() const override { return late_pulses_; }
  bool may_have_lost_steps() const override { return may_have_lost_steps_; }
  int steps_per_period() const override { return motion_.steps_per_period; }
  void set_position(std::int64_t position) override {
    base_ += position_ - position;
    position_ = position;
  }
  void release() override {}

  /// Lets simulated time pass after a move: a heavy platform may still swing.
  void swing(std::chrono::duration<double> time);

  /// Has a pulse of the next move come late. @param pulse  counted from 1
  void delay_pulse(std::int64_t pulse, std::chrono::duration<double> late) {
    late_ = {.pulse = pulse, .by = late.count()};
  }

  /// Where the platform is, radians. Its motor may have lost steps.
  double angle() const;

 private:
  struct Move;
  struct Late {
    std::int64_t pulse = 0;
    double by = 0;  // simulated seconds
  };

  std::chrono::steady_clock::duration real_time(double seconds) const;
  double field() const;
  void plan_pulse(Move& move);
  void make_pulses(Move& move, double until);
  bool settle(const std::stop_token& stop);

  std::function<void(double)> turned_;
  double speed_;
  Motion configured_;
  Motion motion_;
  std::int64_t position_;
  std::int64_t base_ = 0;  // the field's position less `position_`, once that was corrected
  Late late_ = {};
  int late_pulses_ = 0;
  bool may_have_lost_steps_ = false;
  std::optional<LoadedMotor> platform_;
};

}  // namespace octurn
