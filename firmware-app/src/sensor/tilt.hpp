#pragma once

namespace octurn {

/// How a sensor stands, by its accelerometer.
struct Tilt {
  double pitch = 0;  ///< radians, positive when it looks up
  double roll = 0;   ///< radians, positive when its right side, seen from behind, is the lower
};

}  // namespace octurn
