#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "turntable/motion.hpp"

namespace octurn {

/// From here on a pulse is late. A wake-up takes up to 0.1 ms on a Pi; at 800 steps/s, 0.5 ms more
/// than the 1.25 ms of a step take a quarter of the speed.
inline constexpr std::chrono::microseconds late_after(500);

/// Pulses that came late because the system had no time for this program.
struct LatePulses {
  int count = 0;
  std::chrono::steady_clock::duration longest = {};
};

/// The pulses of one move on the STEP line of an A4988, which steps as the line rises.
///
/// Each change of the line is planned from the time at which the last one was done, so a late pulse
/// is never caught up: bunched pulses lose steps, late ones do not. The speed that the motor lost
/// by then it gains again along the ramp.
class PulseTrain {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Change {
    bool high = false;
    Time due = {};
  };

  PulseTrain(const Motion& motion, std::int64_t steps, Time start);

  /// The next change of the line; nothing after the last pulse.
  const std::optional<Change>& next() const { return next_; }

  /// Tells that the next change was made, and when.
  void done(Time time);

  const LatePulses& late() const { return late_; }

 private:
  void plan_rise(Time low_since);

  SpeedProfile profile_;
  Time risen_ = {};         // the last pulse, or the beginning
  Time planned_rise_ = {};  // the next one, if nothing delays it
  std::optional<Change> next_ = {};
  LatePulses late_ = {};
};

}  // namespace octurn
