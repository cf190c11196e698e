#include "turntable/wake_ups.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "turntable/real_time.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

Lateness measure_wake_ups(int count, std::chrono::microseconds interval) {
  Lateness lateness;
  lateness.reserve(static_cast<std::size_t>(count));
  std::thread([&] {
    ask_for_punctual_wake_ups();
    for (int i = 0; i < count; ++i) {
      const Clock::time_point due = Clock::now() + interval;
      std::this_thread::sleep_until(due);
      lateness.push_back(Clock::now() - due);
    }
  }).join();
  std::ranges::sort(lateness);
  return lateness;
}

}  // namespace octurn
