#pragma once

#include <memory>

#include "sensor/depth_sensor.hpp"

namespace octurn {

/// How a simulated platform follows its motor; by default without faults.
struct SimulatedMechanism {
  double rate = 1;  ///< turns of the platform per commanded turn; < 0: the wrong way round
  double play = 0;  ///< backlash of the gears, radians at the platform
};

/// Wraps a simulated sensor so that it sees the platform at the mechanism's angle.
std::unique_ptr<DepthSensor> on_mechanism(std::unique_ptr<DepthSensor> sensor,
                                          const SimulatedMechanism& mechanism);

}  // namespace octurn
