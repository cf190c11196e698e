#pragma once

namespace octurn {

/// A sensor's attitude against gravity, from its accelerometer.
struct Tilt {
  double pitch = 0;  ///< radians, positive when the sensor looks up
  double roll = 0;   ///< radians, positive when the right side, seen from behind, is lower
};

}  // namespace octurn
