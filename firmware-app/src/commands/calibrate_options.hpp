#pragma once

#include <CLI/CLI.hpp>

#include "commands/commands.hpp"

namespace octurn {

/// Options of `octurn calibrate`, by what it is to find.
struct CalibrateOptions {
  CalibrateArguments pose = {};  ///< and what all have in common
  CalibrateWallArguments wall = {};
  CalibrateBoardArguments board = {};
};

/// Adds the command. @param options, status  outlive the parsing
void add_calibrate(CLI::App& program, CalibrateOptions& options, int& status);

}  // namespace octurn
