#pragma once

#include <sched.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

namespace octurn {

/// The SCHED_FIFO priority of the thread that makes the stepper's pulses: above every ordinary
/// program, below the kernel's own threads, which have 50. Without CAP_SYS_NICE, the kernel refuses
/// it unless RLIMIT_RTPRIO (LimitRTPRIO= of a systemd unit) is at least as high.
inline constexpr int real_time_priority = 40;

/// Gives the calling thread `real_time_priority`.
/// @return 0, or the errno value of the kernel's refusal
int ask_for_real_time_priority();

/// Has the calling thread wake up in time, as far as the system allows it: with
/// `real_time_priority`, or without the 50 us by which the kernel delays ordinary threads to save
/// power; and on `core_of_pulses`.
/// @return 0, or the errno value of the kernel's refusal of the priority
int ask_for_punctual_wake_ups();

/// The core that the pulses have for themselves: the last one of four or more; else none.
std::optional<std::size_t> core_of_pulses(const cpu_set_t& cores);

/// Keeps the calling thread, and those that it starts, away from `core_of_pulses` as long as this
/// lives.
class OtherCores {
 public:
  OtherCores();
  ~OtherCores();
  OtherCores(const OtherCores&) = delete;
  OtherCores& operator=(const OtherCores&) = delete;

 private:
  std::optional<cpu_set_t> before_;
};

/// Gives the calling thread the ordinary time-sharing policy (SCHED_OTHER) again.
void give_up_real_time_priority();

/// Delays of a thread's wake-ups after their due times, ascending.
using Lateness = std::vector<std::chrono::steady_clock::duration>;

/// Measures the wake-ups of a thread at even intervals, as for pulses, with the priority of the
/// stepper's thread as far as the system grants it. Takes count * interval.
/// @param count  number of wake-ups, at least 1
Lateness measure_wake_ups(int count, std::chrono::microseconds interval);

}  // namespace octurn
