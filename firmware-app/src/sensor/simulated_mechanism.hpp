#pragma once

#include <memory>

#include "sensor/depth_sensor.hpp"

namespace octurn {

/// How a simulated platform follows its motor; by default as it is told.
struct SimulatedMechanism {
  double rate = 1;  ///< turns of the platform for one that the motor is told; < 0: clockwise
  double play = 0;  ///< of the gears, radians of the platform
};

/// A simulated sensor that sees the platform where such a mechanism has it.
std::unique_ptr<DepthSensor> on_mechanism(std::unique_ptr<DepthSensor> sensor,
                                          const SimulatedMechanism& mechanism);

}  // namespace octurn
