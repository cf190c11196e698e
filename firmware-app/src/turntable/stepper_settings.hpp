#pragma once

#include <chrono>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/json_object.hpp"
#include "turntable/gpio_lines.hpp"
#include "turntable/motion.hpp"

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

/// The GPIO lines to the inputs of a driver.
struct StepperLines {
  std::string step = "GPIO17";
  std::string direction = "GPIO27";
  std::string enable = "GPIO5";              ///< pulled up while the Pi boots, as GPIO0 to 8 are
  std::vector<std::string> microsteps = {};  ///< as in `Microstepping`; empty: fixed levels
};

/// The stepper's wiring, gear and motion; `fields` explains each of them.
struct StepperSettings {
  StepperLines lines = {};
  StepperDriver driver = StepperDriver::a4988;
  int microsteps = 4;     ///< in a full step; the driver knows them
  int full_steps = 200;   ///< in a turn of the motor
  double gear_ratio = 1;  ///< turns of the motor for one of the platform
  bool reversed = false;  ///< DIR high turns the platform clockwise
  // Of the platform. A NEMA 17 of 0.2 N m starts and stops a disc of 28 cm on its shaft
  // (0.005 kg m^2) by these without losing a step.
  double speed_deg_per_second = 90;
  double start_speed_deg_per_second = 18;
  double acceleration_deg_per_second2 = 67.5;
  std::chrono::milliseconds settle_time = std::chrono::milliseconds(300);
  std::chrono::milliseconds idle_release = std::chrono::seconds(60);
  int take_up_steps = 0;  ///< against the gears' backlash
};

/// Settings from the object "turntable" of octurn.json, each key with its unit.
/// @throws Error "bad-config"  with the key, its value and the allowed ones; also for an unknown
/// key
StepperSettings stepper_settings_from(const nlohmann::json& object);

/// The inverse of `stepper_settings_from`, with every key.
nlohmann::json to_json(const StepperSettings& settings);

struct Field;
std::vector<Field> fields(StepperSettings& settings);

/// Reads the speeds of version 0.1, in steps, where no other is given, and refuses settings that
/// contradict each other. Lowers a default start speed to the speed if that is less.
/// @param keys  JSON of the settings
void check_stepper_settings(JsonObject& keys, StepperSettings& settings);

/// The motion in microsteps; the microsteps of a platform's turn are rounded to a whole number. Its
/// speed is at most 5,000 steps a second: beyond that Linux does not wake up in time.
Motion to_motion(const StepperSettings& settings);

/// The lines in the order of `Stepper::Line`, then those of the microsteps, at levels that keep the
/// motor off.
std::vector<NamedLine> to_gpio_lines(const StepperSettings& settings);

}  // namespace octurn
