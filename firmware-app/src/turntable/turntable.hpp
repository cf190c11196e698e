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

  /// The current position, microsteps.
  virtual std::int64_t position() const = 0;

  /// The number of pulses that came late so far. They slowed the motor down; none was lost.
  virtual int late_pulses() const = 0;

  /// Switches the motor off. The next move switches it on again.
  virtual void release() = 0;
};

}  // namespace octurn
