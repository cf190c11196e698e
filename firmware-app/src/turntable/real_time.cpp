#include "turntable/real_time.hpp"

#include <pthread.h>
#include <sched.h>

namespace octurn {

int ask_for_real_time_priority() {
  const sched_param parameters{.sched_priority = real_time_priority};
  return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

void give_up_real_time_priority() {
  const sched_param parameters{.sched_priority = 0};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &parameters);
}

}  // namespace octurn
