#pragma once

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

}  // namespace octurn
