#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace octurn {

/// Holds what was recorded to a live sensor's 30 frames a second at most.
class Pace {
 public:
  /// Waits until the next frame is due. @return false if stopped first
  bool wait(const std::stop_token& stop) {
    constexpr auto period = std::chrono::microseconds(33'333);
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, due_, [] { return false; });
    due_ = std::max(due_ + period, std::chrono::steady_clock::now());
    return !stop.stop_requested();
  }

 private:
  std::chrono::steady_clock::time_point due_ = {};
  std::mutex mutex_;  // guards nothing: what the condition needs to wait
  std::condition_variable_any wake_;
};

}  // namespace octurn
