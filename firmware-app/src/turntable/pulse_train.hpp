#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "turntable/motion.hpp"

namespace octurn {

/// The delay from which a pulse counts as late. A wake-up takes up to 0.1 ms on a Pi. At 800
/// steps/s, whose step takes 1.25 ms, a delay of 0.5 ms costs more than a quarter of the speed.
inline constexpr std::chrono::microseconds late_after(500);

/// Count and longest delay of pulses that were late because the system scheduled their thread late.
struct LatePulses {
  int count = 0;
  std::chrono::steady_clock::duration longest = {};
  bool may_have_lost_steps = false;
};

/// The pulses of one move on the STEP line of an A4988, which steps on a rising edge.
///
/// Each edge is scheduled from the time of the last one, so that a delay is never caught up: pulses
/// too close together lose steps. The motor regains the lost speed along the ramp. A heavy platform
/// runs on meanwhile, and may lose steps, too.
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

  /// Reports that the next change was made. @param time  of the change
  void done(Time time);

  /// Shortens the move to its braking distance. @return false if it may end at once
  bool brake() { return profile_.brake(); }

  const LatePulses& late() const { return late_; }

 private:
  void plan_rise(Time low_since);

  Motion motion_;
  SpeedProfile profile_;
  Time risen_ = {};         // the last rising edge, or the start
  Time planned_rise_ = {};  // the next rising edge, without delays
  std::optional<Change> next_ = {};
  LatePulses late_ = {};
};

}  // namespace octurn
