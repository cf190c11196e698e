#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <thread>

namespace octurn {

/// Blocks SIGINT and SIGTERM in this thread and those that it starts, and ignores SIGPIPE and
/// SIGXFSZ, so that a reader that has gone and a file that may not grow are errors of `write`. To
/// be called before the first thread.
void block_signals();

/// Undoes that, for a program that this process becomes.
void unblock_signals();

/// Waits for SIGINT or SIGTERM, which are blocked.
void wait_for_signal();

/// The same, but no longer than `limit`. @return whether one came
bool wait_for_signal(std::chrono::microseconds limit);

/// @throws Error "stopped", always: a signal ended the command, which leaves behind what `outcome`
/// says
[[noreturn]] void throw_stopped(const std::string& outcome = {});

/// Turns SIGINT and SIGTERM, which are blocked, into a stop request as long as it lives.
class SignalStop {
 public:
  SignalStop();
  ~SignalStop();
  SignalStop(const SignalStop&) = delete;
  SignalStop& operator=(const SignalStop&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_ = {};
  std::jthread waiter_;
};

}  // namespace octurn
