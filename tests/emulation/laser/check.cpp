// Runs on the emulated Pi and takes the pictures of a scan by laser line with Octurn's own rig: the
// camera through libcamera and the kernel's uvcvideo, lasers and stepper on the chip's GPIO lines.
//
// usage: laser_check STOPS: takes the pictures, then waits for a signal with all devices open. Each
// picture that counts is marked in the kernel's trace. laser.test.mjs checks the output.

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/plan.hpp"
#include "capture/take_pictures.hpp"
#include "octurn/error.hpp"
#include "signal_stop.hpp"

namespace octurn {

/// The rig has no depth sensor, and this program is not linked to OpenNI2.
std::unique_ptr<DepthSensor> open_sensor(const std::string& /*uri*/) { return nullptr; }

namespace {

void say(const std::string& text) { std::cout << "check: " << text << std::endl; }

void mark(const std::string& text) {
  std::ofstream("/sys/kernel/tracing/trace_marker") << text << "\n";
}

/// The column of the brightest pixel in the middle row, or "dark".
std::string line_in(const Picture& picture) {
  const auto row = picture.samples.begin() + picture.height / 2 * picture.width;
  const auto brightest = std::max_element(row, row + picture.width);
  return *brightest < 128 ? "dark" : std::to_string(brightest - row);
}

void take(int stops) {
  const SignalStop signal;
  LaserSettings laser;
  laser.lens.width = 320;
  laser.lens.height = 240;
  laser.exposure = std::chrono::milliseconds(100);
  Rig rig({.stepper = StepperSettings{}, .laser = laser});
  rig.lasers().late_pictures = 0;  // each light has one picture
  const ScanObserver observer{.on_picture = [](const Picture&) { mark("PICTURE"); }};
  const int steps = rig.turntable().steps_per_turn();
  for (const std::int64_t position : stop_positions(0, steps, stops)) {
    const auto taken =
        take_pictures(rig, {.index = 0, .position = position}, signal.token(), observer);
    if (!taken) {
      mark("STOPPED");
      say("stopped");
      return;
    }
    std::string lines;
    for (const Picture& picture : taken->pictures) {
      lines += " " + line_in(picture);
    }
    say("at " + std::to_string(position) + ":" + lines);
  }
  rig.release_turntable();
  mark("IDLE");
  say("idle");
  while (!signal.token().stop_requested()) {
    rig.camera().read(signal.token());
  }
}

}  // namespace
}  // namespace octurn

int main(int /*count*/, char** arguments) {
  octurn::block_signals();
  try {
    octurn::take(std::atoi(arguments[1]));
    return 0;
  } catch (const octurn::Error& error) {
    octurn::mark("FAILED");
    octurn::say(std::string(to_string(error.code())) + ": " + error.what());
    return 1;
  }
}
