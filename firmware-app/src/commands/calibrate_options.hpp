#pragma once

#include "commands/commands.hpp"

namespace CLI {
class App;
}

namespace octurn {

/// Options of `octurn calibrate`, grouped by the quantity that it measures.
struct CalibrateOptions {
  CalibrateArguments pose = {};  ///< also holds the options that all three share
  CalibrateWallArguments wall = {};
  CalibrateBoardArguments board = {};
};

/// Adds the command. @param options, status  outlive the parsing
void add_calibrate(CLI::App& program, CalibrateOptions& options, int& status);

}  // namespace octurn
