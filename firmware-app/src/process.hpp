#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octurn {

/// Exit status and output of a program.
struct ProgramResult {
  int status = 0;           ///< as in a shell: 128 + the signal's number if a signal ended it
  std::string output = {};  ///< standard output, the first 16 MiB
  std::string errors = {};  ///< standard error, the first 16 MiB
};

/// Runs a program without a shell and waits until it ends. A stop request kills it (SIGKILL).
/// @param command  the program, searched in PATH unless its name has a slash, and its arguments
/// @throws Error "not-found"  if it cannot be started; Stopped
ProgramResult run_program(const std::vector<std::string>& command, const std::stop_token& stop);

/// Makes malloc keep freed memory for reuse (mallopt(3)). Each snapshot allocates as much as the
/// last one, and mapping its pages anew took a tenth of a model's processor time.
void keep_freed_memory();

/// Makes malloc return every large block to the kernel as soon as it is freed. Otherwise a thread's
/// arena keeps its freed blocks for that thread alone, and the process exceeds its memory limit: by
/// 24 MB with two threads.
void return_freed_memory();

/// Returns this machine's host name (gethostname(2)).
std::string host_name();

// Notifications to systemd (sd_notify(3)). Without systemd they do nothing.

/// Says that the daemon is ready. @param status  a line for `systemctl status`
void notify_ready(const std::string& status);

/// Says that the daemon is ending.
void notify_stopping();

/// Timeout of systemd's watchdog; nothing if it is off.
std::optional<std::chrono::microseconds> watchdog_interval();

/// Resets the watchdog's timeout.
void notify_alive();

}  // namespace octurn
