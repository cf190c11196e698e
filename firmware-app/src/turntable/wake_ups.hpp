#pragma once

#include <chrono>
#include <vector>

namespace octurn {

/// How long after its time a thread woke up, for each of its wake-ups, the shortest first.
using Lateness = std::vector<std::chrono::steady_clock::duration>;

/// Has a thread with the priority of the stepper's, as far as the system grants that, wake up at
/// even intervals, as for pulses. Takes count * interval.
/// @param count  of wake-ups, at least 1
Lateness measure_wake_ups(int count, std::chrono::microseconds interval);

}  // namespace octurn
