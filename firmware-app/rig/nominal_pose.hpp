#pragma once

#include <Eigen/Geometry>

#include "octurn/units.hpp"

namespace octurn {

/// The sensor's pose on a rig built to the drawing: 0.62 m in front of the platform's axis, 0.36 m
/// above its surface, looking 25 degrees down. It is the default of a rig without a calibration.
/// @return optical frame to platform frame, metres
inline Eigen::Isometry3d nominal_platform_from_sensor() {
  constexpr double down = radians_from_degrees(25.0);
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  platform_from_sensor.linear() << 1, 0, 0,  //
      0, -std::sin(down), std::cos(down),    //
      0, -std::cos(down), -std::sin(down);
  platform_from_sensor.translation() << 0, -0.62, 0.36;
  return platform_from_sensor;
}

}  // namespace octurn
