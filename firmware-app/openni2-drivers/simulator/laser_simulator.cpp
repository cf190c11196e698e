// The module that simulates a camera with line lasers.

#include <memory>

#include "rig/laser_simulation.hpp"
#include "simulator/laser_scene.hpp"

namespace octurn {
namespace {

std::unique_ptr<LaserSimulator> make(const LaserSimulation& simulation) {
  return std::make_unique<LaserScene>(simulation);
}

}  // namespace
}  // namespace octurn

extern "C" __attribute__((visibility("default")))
const octurn::LaserSimulatorModule octurn_laser_simulator;
extern "C" const octurn::LaserSimulatorModule octurn_laser_simulator{.make = octurn::make};
