#pragma once

#include <chrono>
#include <optional>

#include "turntable/motion.hpp"

namespace octurn {

/// Pulses that came late, which is when the system had no time for this program.
struct LatePulses {
  int count = 0;
  std::chrono::steady_clock::duration longest = {};
};

/// The pulses of one move on the STEP line of an A4988, which steps as the line rises.
///
/// It plans each change of the line from the time at which the last one was done. So a pulse that
/// comes late is never caught up: bunched pulses lose steps, late ones do no harm. What speed the
/// motor has lost by then it gains again along the ramp.
class PulseTrain {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Change {
    bool high = false;
    Time due = {};
  };

  PulseTrain(const Motion& motion, int steps, Time start);

  /// What the line has to do next; nothing after the last pulse.
  const std::optional<Change>& next() const { return next_; }

  /// That change is done, and was so at that time.
  void done(Time time);

  const LatePulses& late() const { return late_; }

 private:
  void plan_rise(Time low_since);

  Course course_;
  Time risen_ = {};         // the last pulse, or the beginning
  Time planned_rise_ = {};  // the next one, if nothing delays it
  std::optional<Change> next_ = {};
  LatePulses late_ = {};
};

}  // namespace octurn
