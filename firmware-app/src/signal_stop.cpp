#include "signal_stop.hpp"

#include <pthread.h>
#include <signal.h>

#include "octurn/error.hpp"

namespace octurn {
namespace {

sigset_t ending_signals() {
  sigset_t signals{};
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  ::sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

void throw_stopped(const std::string& outcome) {
  throw Error(ErrorCode::stopped,
              "stopped before the end" + (outcome.empty() ? "" : ": " + outcome));
}

void block_signals() {
  const sigset_t signals = ending_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
}

void unblock_signals() {
  const sigset_t signals = ending_signals();
  ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_DFL);
  ::signal(SIGXFSZ, SIG_DFL);
}

void wait_for_signal() {
  const sigset_t signals = ending_signals();
  int signal = 0;
  ::sigwait(&signals, &signal);
}

bool wait_for_signal(std::chrono::microseconds limit) {
  const sigset_t signals = ending_signals();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(limit);
  const timespec wait{.tv_sec = seconds.count(),
                      .tv_nsec = std::chrono::nanoseconds(limit - seconds).count()};
  return ::sigtimedwait(&signals, nullptr, &wait) > 0;
}

SignalStop::SignalStop()
    : waiter_([this] {
        wait_for_signal();
        source_.request_stop();
      }) {}

SignalStop::~SignalStop() {
  // Ends the waiter's sigwait(3). The signal is sent to that thread only, not to the process.
  ::pthread_kill(waiter_.native_handle(), SIGTERM);
}

}  // namespace octurn
