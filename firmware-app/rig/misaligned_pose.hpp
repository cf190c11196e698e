#pragma once

#include <Eigen/Geometry>

#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {

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
