#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <thread>

namespace octurn {

/// Blocks SIGINT and SIGTERM in this thread and the threads that it starts. Ignores SIGPIPE and
/// SIGXFSZ, so that write(2) reports a closed pipe (EPIPE) and the file size limit (EFBIG). Call it
/// before the first thread starts.
void block_signals();

/// Undoes `block_signals`, before this process executes another program.
void unblock_signals();

/// Waits for SIGINT or SIGTERM, which are blocked.
void wait_for_signal();

/// Waits for at most `limit`. @return whether a signal came
bool wait_for_signal(std::chrono::microseconds limit);

/// Throws the Error "stopped" of a command that a signal has ended.
/// @param outcome  what the command leaves behind; may be empty
[[noreturn]] void throw_stopped(const std::string& outcome = {});

/// Turns SIGINT and SIGTERM into a stop request during its lifetime. They have to be blocked.
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
