#pragma once

#include <algorithm>
#include <chrono>
#include <stop_token>

#include "rig/interruptible_sleep.hpp"

namespace octurn {

/// Limits the frames of a recording to a live sensor's 30 a second.
class FrameLimiter {
 public:
  /// Waits until the next frame is due. @return false if a stop was requested first
  bool wait(const std::stop_token& stop) {
    constexpr auto period = std::chrono::microseconds(33'333);
    const bool is_due = sleep_until(stop, due_);
    due_ = std::max(due_ + period, std::chrono::steady_clock::now());
    return is_due;
  }

 private:
  std::chrono::steady_clock::time_point due_ = {};
};

}  // namespace octurn
