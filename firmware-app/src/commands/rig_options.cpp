#include "commands/commands.hpp"
#include "rig/simulation.hpp"

namespace octurn {

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
          .speed = arguments.speed};
}

}  // namespace octurn
