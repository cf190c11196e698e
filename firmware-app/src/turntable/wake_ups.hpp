#pragma once

#include <chrono>
#include <vector>

namespace octurn {

/// Delays of a thread's wake-ups after their due times, ascending.
using Lateness = std::vector<std::chrono::steady_clock::duration>;

/// Measures the wake-ups of a thread at even intervals, as for pulses, with the priority of the
/// stepper's thread as far as the system grants it. Takes count * interval.
/// @param count  number of wake-ups, at least 1
Lateness measure_wake_ups(int count, std::chrono::microseconds interval);

}  // namespace octurn
