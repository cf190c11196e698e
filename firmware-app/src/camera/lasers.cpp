#include "camera/lasers.hpp"

#include <sys/prctl.h>

#include <fstream>
#include <system_error>
#include <utility>

#include "failure.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "turntable/gpio_lines.hpp"

namespace octurn {
namespace {

/// The header with lines of lasers, whose errors are the sensor's and not the turntable's.
GpioChip drive_lasers(const std::vector<NamedLine>& lines) {
  try {
    return drive_header(lines,
                        "Correct the lasers' lines in octurn.txt on the card: they are lines of "
                        "GPIO9 to GPIO27 that nothing else uses.");
  } catch (const Error& error) {
    const bool is_absence = error.code() == ErrorCode::turntable_missing;
    throw Error(is_absence ? ErrorCode::sensor_missing : ErrorCode::sensor_failed,
                std::string("lasers: ") + error.what(), error.hint());
  }
}

}  // namespace

Lasers::Light::Light(Lasers& lasers, std::size_t laser) : lasers_(lasers), laser_(laser) {
  if (!lasers.set_line_) {
    throw Error(ErrorCode::sensor_failed,
                "a laser could not be switched off, so that the lines of all were released",
                "Pull the lasers' plug, and look at their wires.");
  }
  try {
    lasers.set_line_(laser, true);
  } catch (...) {
    lasers.switch_off(laser);  // whatever has become of it
    throw;
  }
}

Lasers::Light::~Light() { lasers_.switch_off(laser_); }

Lasers::Lasers(std::size_t count, SetLine set_line)
    : count_(count), set_line_(std::move(set_line)) {
  for (std::size_t laser = 0; laser < count_; ++laser) {
    switch_off(laser);
  }
}

Lasers::~Lasers() {
  for (std::size_t laser = 0; laser < count_; ++laser) {
    switch_off(laser);
  }
}

/// Where its line cannot be set, all lines are released, which switches their lasers off.
void Lasers::switch_off(std::size_t laser) {
  if (!set_line_) {
    return;
  }
  try {
    set_line_(laser, false);
  } catch (...) {
    log::error("laser", current_failure().detail);
    set_line_ = nullptr;
  }
}

Lasers::SetLine open_laser_lines(const std::vector<std::string>& lines) {
  expect_released_lines_to_fall();
  // The kernel releases the lines of a program that has crashed only after its memory was dumped,
  // which takes seconds on a Pi: a laser would be on for so long.
  ::prctl(PR_SET_DUMPABLE, 0);
  std::vector<NamedLine> named;
  named.reserve(lines.size());
  for (const std::string& line : lines) {
    named.push_back({.name = line, .high = false});
  }
  // Shared, as a std::function has to be copyable.
  return
      [lines, chip = std::make_shared<GpioChip>(drive_lasers(named))](std::size_t laser, bool on) {
        try {
          chip->set(laser, on);
        } catch (const std::system_error& error) {
          throw Error(ErrorCode::sensor_failed,
                      "line " + lines[laser] + " cannot be set: " + error.what(),
                      "Start Octurn again.");
        }
      };
}

void expect_released_lines_to_fall(const std::filesystem::path& sys) {
  // The chips of the Pi 4 and older, and of the Pi 5.
  for (const char* const driver : {"pinctrl_bcm2835", "pinctrl_rp1"}) {
    std::ifstream parameter(sys / "module" / driver / "parameters" / "persist_gpio_outputs");
    char value = 'N';
    if (parameter >> value && value == 'Y') {
      throw Error(ErrorCode::sensor_failed,
                  std::string("lasers: this kernel keeps a laser on if Octurn crashes, as ") +
                      driver + ".persist_gpio_outputs is Y",
                  "Add the line dtparam=strict_gpiod to /boot/firmware/config.txt, and start the "
                  "Raspberry Pi again.");
    }
  }
}

}  // namespace octurn
