#pragma once

#include <Eigen/Geometry>

#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {

/// The true pose of a simulated sensor whose pose is told to be the drawing's, as somebody has put
/// it up who went by eye. The platform is then seen too low, so that it stays out of the box of a
/// model.
/// @param times  4.7 mm at the platform's centre and 1 degree about it; with 0 the told pose is
/// true
/// @return optical frame to platform frame, metres
inline Eigen::Isometry3d misaligned_platform_from_sensor(double times) {
  const Eigen::Vector3d shift(0.0025, -0.0035, 0.002);
  const Eigen::Vector3d axis(0.8, 0.6, 0);
  return Eigen::Translation3d(times * shift) *
         Eigen::AngleAxisd(times * radians_from_degrees(1.0), axis) *
         nominal_platform_from_sensor();
}

}  // namespace octurn
