#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/register.hpp"

namespace octurn {

/// Object from platform of an object turned over about X by half a turn (at half its height), then
/// about Z, and put down off the platform's centre.
inline Eigen::Isometry3d turned_over(double height, double about_z_deg = 35) {
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  object_from_platform.linear() =
      (Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(radians_from_degrees(about_z_deg), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  object_from_platform.translation() = Eigen::Vector3d(0.008, -0.005, height);
  return object_from_platform;
}

/// The turn of an object that lies in that pose, on a calibrated rig.
inline RegistrationTurn laid_turn(
    const Shape& object, std::size_t stops,
    const Eigen::Isometry3d& object_from_platform = Eigen::Isometry3d::Identity()) {
  const Shape lying = [=](const Eigen::Vector3d& p) { return object(object_from_platform * p); };
  CalibrationTurn turn = rendered_turn(lying, stops);
  return {.intrinsics = turn.intrinsics,
          .platform_from_sensor = turn.platform_from_sensor,
          .angles = turn.angles,
          .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}},
          .read = turn.read};
}

/// A cylinder that stands on the platform.
inline Shape cylinder(double radius, double height) {
  return [=](const Eigen::Vector3d& p) {
    const Eigen::Array2d out(p.head<2>().norm() - radius,
                             std::abs(p.z() - height / 2) - height / 2);
    return out.max(0.0).matrix().norm() + std::min(out.maxCoeff(), 0.0);
  };
}

/// Height of `figure()`, metres. Its underside is flat; turned over, it stands on its balls.
inline constexpr double figure_height = 0.12;

}  // namespace octurn
