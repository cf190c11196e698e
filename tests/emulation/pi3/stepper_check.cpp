// Runs on the emulated Pi: moves to each position of its command line with Octurn's own stepper on
// the chip's GPIO lines, and prints its position. SIGTERM stops it, which is marked in the kernel's
// trace.

#include <charconv>
#include <cstring>
#include <fstream>
#include <iostream>
#include <stop_token>
#include <string_view>
#include <vector>

#include "octurn/error.hpp"
#include "signal_stop.hpp"
#include "turntable/stepper.hpp"

namespace octurn {
namespace {

void turn(const std::vector<int>& positions) {
  const SignalStop signal;
  const std::stop_callback tell(
      signal.token(), [] { std::ofstream("/sys/kernel/tracing/trace_marker") << "STOP\n"; });
  const StepperSettings settings = {.lines = {.microsteps = {"GPIO22", "GPIO23", "GPIO24"}}};
  Stepper stepper(settings, open_gpio_lines(settings));
  bool arrived = true;
  for (const int position : positions) {
    arrived = arrived && stepper.move_to(position, signal.token());
  }
  const LatePulses late = stepper.late();
  std::cout << (arrived ? "arrived" : "stopped") << " at " << stepper.position()
            << ", late pulses: " << late.count << std::endl;
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  octurn::block_signals();
  std::vector<int> positions;
  for (int i = 1; i < argc; ++i) {
    int position = 0;
    std::from_chars(argv[i], argv[i] + std::strlen(argv[i]), position);
    positions.push_back(position);
  }
  try {
    octurn::turn(positions);
    return 0;
  } catch (const octurn::Error& error) {
    std::cout << to_string(error.code()) << ": " << error.what() << std::endl;
    return 1;
  }
}
