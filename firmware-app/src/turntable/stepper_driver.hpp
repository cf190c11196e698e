#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace octurn {

/// A stepper's driver with the inputs STEP, DIR and ENABLE.
enum class StepperDriver {
  a4988,
  drv8825,
  tmc2209,  ///< standalone, without its serial port
};

/// As in octurn.json, such as "A4988".
std::string_view to_string(StepperDriver driver);

/// Microsteps in a full step that a driver can be set to, and the levels of its inputs for them:
/// MS1, MS2 and MS3 of an A4988, MODE0 to MODE2 of a DRV8825, MS1 and MS2 of a TMC2209.
struct Microstepping {
  int microsteps = 1;
  std::vector<bool> levels = {};
};

/// From coarse to fine.
std::vector<Microstepping> microsteppings(StepperDriver driver);

}  // namespace octurn
