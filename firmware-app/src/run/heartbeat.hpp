#pragma once

#include <atomic>
#include <chrono>

namespace octurn {

/// Shows that a thread is still working. Any thread may read it.
class Heartbeat {
 public:
  using Clock = std::chrono::steady_clock;

  /// Called by the thread between two of its waits.
  void beat() { last_ = Clock::now().time_since_epoch().count(); }

  /// Called before work of unbounded duration, such as a reconstruction: alive until the next beat.
  void suspend() { last_ = Clock::duration::max().count(); }

  /// Whether the last beat is not older than `max_silence`.
  bool is_alive(Clock::duration max_silence) const {
    const Clock::duration last(last_.load());
    return last == Clock::duration::max() || Clock::now().time_since_epoch() - last <= max_silence;
  }

 private:
  std::atomic<Clock::rep> last_ = Clock::now().time_since_epoch().count();
};

}  // namespace octurn
