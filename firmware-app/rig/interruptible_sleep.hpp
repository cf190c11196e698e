#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace octurn {

/// Blocks the calling thread until a time of the steady clock, or until a stop is requested.
/// @return false if a stop was requested, even if `time` has come as well
inline bool sleep_until(const std::stop_token& stop, std::chrono::steady_clock::time_point time) {
  std::mutex mutex;  // guards nothing: a condition variable waits only with a lock
  std::condition_variable_any never_notified;
  std::unique_lock lock(mutex);
  never_notified.wait_until(lock, stop, time, [] { return false; });
  return !stop.stop_requested();
}

/// The same for a duration from now.
inline bool sleep_for(const std::stop_token& stop, std::chrono::steady_clock::duration duration) {
  return sleep_until(stop, std::chrono::steady_clock::now() + duration);
}

}  // namespace octurn
