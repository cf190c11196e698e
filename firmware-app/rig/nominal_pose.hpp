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

/// The true pose of a simulated sensor that was mounted by eye, while the configured pose is
/// nominal. The error makes the platform appear too low, so that it stays outside of a model's clip
/// box.
/// @param times  factor of the error, 4.7 mm at the platform's centre and 1 degree about it; 0:
/// none
/// @return optical frame to platform frame, metres
inline Eigen::Isometry3d misaligned_platform_from_sensor(double times) {
  const Eigen::Vector3d shift(0.0025, -0.0035, 0.002);
  const Eigen::Vector3d axis(0.8, 0.6, 0);
  return Eigen::Translation3d(times * shift) *
         Eigen::AngleAxisd(times * radians_from_degrees(1.0), axis) *
         nominal_platform_from_sensor();
}

}  // namespace octurn
