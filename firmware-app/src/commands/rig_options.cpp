#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "simulator/simulation.hpp"

namespace octurn {

RigOptions rig_options(const RigArguments& arguments) {
  if (!arguments.simulate) {
    throw Error("no-turntable", "this version drives the simulated turntable only",
                "Add --simulate.");
  }
  const std::string simulated =
      simulation_uri({.mesh_file = arguments.mesh_file, .speed = arguments.speed});
  return {.sensor_uri = arguments.sensor_uri.empty() ? simulated : arguments.sensor_uri,
          .speed = arguments.speed};
}

}  // namespace octurn
