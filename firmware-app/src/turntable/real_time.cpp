#include "turntable/real_time.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

namespace octurn {

int ask_for_real_time_priority() {
  const sched_param parameters{.sched_priority = real_time_priority};
  return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

int ask_for_punctual_wake_ups() {
  const int failure = ask_for_real_time_priority();
  if (failure != 0) {
    ::prctl(PR_SET_TIMERSLACK, 1UL);
  }
  return failure;
}

void give_up_real_time_priority() {
  const sched_param parameters{.sched_priority = 0};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &parameters);
}

}  // namespace octurn
