#pragma once

#include <stop_token>
#include <string>
#include <vector>

namespace octurn {

/// How a program ended, and what it said.
struct ProgramResult {
  int status = 0;  ///< as shells have it: 128 and the signal, if one has ended it
  std::string output = {};
  std::string errors = {};
};

/// Runs a program, without a shell, to its end. A stop request kills it.
/// @param command  the program, which is looked for in PATH unless it is a path, and its arguments
/// @throws Error "not-found"  if it cannot be started; Stopped
ProgramResult run_program(const std::vector<std::string>& command, const std::stop_token& stop);

}  // namespace octurn
