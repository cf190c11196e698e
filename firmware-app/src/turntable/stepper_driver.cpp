#include "turntable/stepper_driver.hpp"

namespace octurn {

std::string_view to_string(StepperDriver driver) {
  switch (driver) {
    case StepperDriver::drv8825:
      return "DRV8825";
    case StepperDriver::tmc2209:
      return "TMC2209";
    case StepperDriver::a4988:
      break;
  }
  return "A4988";
}

std::vector<Microstepping> microsteppings(StepperDriver driver) {
  constexpr bool low = false;
  constexpr bool high = true;
  switch (driver) {
    case StepperDriver::drv8825:  // TI's datasheet SLVSA73, table 1
      return {{1, {low, low, low}},   {2, {high, low, low}},  {4, {low, high, low}},
              {8, {high, high, low}}, {16, {low, low, high}}, {32, {high, low, high}}};
    case StepperDriver::tmc2209:  // Trinamic's datasheet, section 3.3: 8 comes first
      return {{8, {low, low}}, {16, {high, high}}, {32, {high, low}}, {64, {low, high}}};
    case StepperDriver::a4988:  // Allegro's datasheet, table 1
      break;
  }
  return {{1, {low, low, low}},
          {2, {high, low, low}},
          {4, {low, high, low}},
          {8, {high, high, low}},
          {16, {high, high, high}}};
}

}  // namespace octurn
