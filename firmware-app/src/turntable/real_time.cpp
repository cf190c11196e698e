#include "turntable/real_time.hpp"

#include <pthread.h>
#include <sched.h>

namespace octurn {
namespace {

// Above every ordinary program, below the kernel's own threads, which have 50.
constexpr int real_time_priority = 40;

}  // namespace

int ask_for_real_time_priority() {
  const sched_param parameters{.sched_priority = real_time_priority};
  return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

void give_up_real_time_priority() {
  const sched_param parameters{.sched_priority = 0};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &parameters);
}

}  // namespace octurn
