#include "turntable/real_time.hpp"

#include <pthread.h>
#include <sys/prctl.h>

#include <algorithm>
#include <thread>

namespace octurn {
namespace {

constexpr int enough_cores = 4;  // a Raspberry Pi's

cpu_set_t cores_of_this_thread() {
  cpu_set_t cores = {};
  ::sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

// The kernel's refusal leaves the thread where it was, which is no failure.
void use_cores(const cpu_set_t& cores) { ::sched_setaffinity(0, sizeof cores, &cores); }

using Clock = std::chrono::steady_clock;

}  // namespace

int ask_for_real_time_priority() {
  const sched_param parameters{.sched_priority = real_time_priority};
  return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

int ask_for_punctual_wake_ups() {
  if (const auto core = core_of_pulses(cores_of_this_thread())) {
    cpu_set_t own = {};
    CPU_SET(*core, &own);
    use_cores(own);
  }
  const int failure = ask_for_real_time_priority();
  if (failure != 0) {
    ::prctl(PR_SET_TIMERSLACK, 1UL);
  }
  return failure;
}

std::optional<std::size_t> core_of_pulses(const cpu_set_t& cores) {
  if (CPU_COUNT(&cores) < enough_cores) {
    return std::nullopt;
  }
  std::size_t last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(last, &cores)) {
    --last;
  }
  return last;
}

OtherCores::OtherCores() {
  const cpu_set_t cores = cores_of_this_thread();
  if (const auto core = core_of_pulses(cores)) {
    before_ = cores;
    cpu_set_t others = cores;
    CPU_CLR(*core, &others);
    use_cores(others);
  }
}

OtherCores::~OtherCores() {
  if (before_) {
    use_cores(*before_);
  }
}

void give_up_real_time_priority() {
  const sched_param parameters{.sched_priority = 0};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &parameters);
}

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
