#pragma once

#include <stop_token>

#include "progress_bar.hpp"
#include "run/scanner.hpp"

namespace octurn {

/// Waits until the scanner's calibration has ended, and cancels it when `stop` is requested.
/// @param show  called again and again to draw the progress
/// @return      the ended run
CalibrationRun follow_calibration(Scanner& scanner, const std::stop_token& stop,
                                  void (*show)(ProgressBar& bar, const CalibrationRun& run));

}  // namespace octurn
