#include "commands/follow_calibration.hpp"

#include <chrono>

namespace octurn {

CalibrationRun follow_calibration(Scanner& scanner, const std::stop_token& stop,
                                  void (*show)(ProgressBar& bar, const CalibrationRun& run)) {
  using namespace std::chrono_literals;
  ProgressBar bar;
  while (scanner.status().busy()) {
    show(bar, **scanner.calibration_run());
    if (stop.stop_requested()) {
      scanner.cancel_calibration();
    }
    scanner.wait_until_done(100ms);
  }
  return **scanner.calibration_run();
}

}  // namespace octurn
