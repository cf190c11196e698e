#include <functional>
#include <memory>

#include "commands/commands.hpp"
#include "octurn/units.hpp"
#include "rig/simulation.hpp"
#include "sensor/simulated_mechanism.hpp"

namespace octurn {

namespace {

/// The simulated platform's motion: a gear or a wire that differs from the settings shows.
SimulatedMechanism to_mechanism(const RigArguments& arguments, const StepperSettings& stepper) {
  const double rate = stepper.gear_ratio / arguments.gear_ratio.value_or(stepper.gear_ratio);
  const bool is_right = !arguments.reversed || stepper.reversed;
  return {.rate = is_right ? rate : -rate, .play = radians_from_degrees(arguments.play_deg)};
}

/// Opens a sensor as usual, but for a mechanism with faults.
std::function<std::unique_ptr<DepthSensor>(const std::string& uri)> sensor_opener(
    const SimulatedMechanism& mechanism) {
  if (mechanism.rate == 1 && mechanism.play == 0) {
    return open_sensor;
  }
  return [mechanism](const std::string& uri) { return on_mechanism(open_sensor(uri), mechanism); };
}

}  // namespace

RigOptions rig_options(const RigArguments& arguments, const StepperSettings& stepper) {
  if (!arguments.simulate) {
    return {.sensor_uri = arguments.sensor_uri, .stepper = stepper};
  }
  const double real_life = arguments.perfect ? 0 : 1;
  const std::string simulated = simulation_uri({.mesh_file = arguments.mesh_file,
                                                .pattern = real_life,
                                                .misalignment = real_life,
                                                .wall = arguments.wall,
                                                .speed = arguments.speed});
  return {.sensor_uri = arguments.sensor_uri.empty() ? simulated : arguments.sensor_uri,
          .speed = arguments.speed,
          .open_sensor = sensor_opener(to_mechanism(arguments, stepper))};
}

}  // namespace octurn
