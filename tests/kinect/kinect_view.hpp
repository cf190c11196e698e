#pragma once

#include <cmath>
#include <cstdint>

#include "kinect/kinect_on_desk.hpp"
#include "octurn/snapshot.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {

/// A noiseless frame of the simulated Kinect.
inline DepthFrame simulated_frame() {
  const auto sensor = open_sensor("octurn-simulator://?noise=0&pattern=0&misalignment=0");
  return sensor->read({}).value().frame;
}

/// The raw readings from which an emulated Kinect gives that frame.
inline Readings readings_of(const DepthFrame& frame) {
  Readings readings;
  for (const std::uint16_t depth : frame.depth) {
    readings.push_back(depth == 0
                           ? std::uint16_t{2047}
                           : static_cast<std::uint16_t>(std::lround(1089.40 - 3454890.0 / depth)));
  }
  return readings;
}

}  // namespace octurn
