#pragma once

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

}  // namespace octurn
