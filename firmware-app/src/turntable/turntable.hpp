#pragma once

#include <cstdint>
#include <stop_token>

namespace octurn {

/// A platform turned by a stepper. Positions are whole microsteps, so that turns add up without
/// rounding. They never wrap: 64 bits last for 5e11 turns of the finest gear. Used by one thread at
/// a time.
class Turntable {
 public:
  virtual ~Turntable() = default;

  /// Microsteps of one turn of the platform.
  virtual int steps_per_turn() const = 0;

  /// Turns to a position (microsteps, counter-clockwise seen from above), waits until the platform
  /// has settled, and holds it there.
  /// @return false if a stop was requested first; `position` is then where it stopped
  /// @throws Error  if the motor cannot be driven
  virtual bool move_to(std::int64_t position, std::stop_token stop) = 0;

  /// Multiplies the configured speeds by a factor, and the acceleration by its square. 1: as
  /// configured. A motor of which the pace 1 asks for a torque is asked for `pace`^2 of it.
  virtual void set_pace(double pace) = 0;

  /// The current position, microsteps.
  virtual std::int64_t position() const = 0;

  /// The number of pulses that came late so far. They slowed the motor down.
  virtual int late_pulses() const = 0;

  /// Whether pulses of the last move came so late that a heavy platform may have lost steps.
  virtual bool may_have_lost_steps() const = 0;

  /// Microsteps of the coils' period: steps are lost in multiples of it.
  virtual int steps_per_period() const = 0;

  /// Corrects the position where the platform is seen to stand. Moves nothing.
  virtual void set_position(std::int64_t position) = 0;

  /// Switches the motor off. The next move switches it on again.
  virtual void release() = 0;
};

}  // namespace octurn
