#pragma once

#include <stop_token>

namespace octurn {

/// A platform turned by a stepper. Positions are whole microsteps, so that a turn sums exactly.
/// Used by one thread at a time.
class Turntable {
 public:
  virtual ~Turntable() = default;

  /// Microsteps of one whole turn of the platform.
  virtual int steps_per_turn() const = 0;

  /// Turns to a position (microsteps, counter-clockwise seen from above, not wrapped), waits until
  /// the platform has settled, and holds it there.
  /// @return false if stopped first; the position is then wherever it stands
  /// @throws Error  if the motor cannot be driven
  virtual bool move_to(int position, std::stop_token stop) = 0;

  /// Where it stands, in microsteps.
  virtual int position() const = 0;

  /// Pulses that came late so far, and slowed it down; none is lost by that.
  virtual int late_pulses() const = 0;

  /// Lets go of the platform. The next move takes hold again.
  virtual void release() = 0;
};

}  // namespace octurn
