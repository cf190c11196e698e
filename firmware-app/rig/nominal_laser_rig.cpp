#include "rig/nominal_laser_rig.hpp"

#include <cmath>
#include <utility>

#include "rig/nominal_pose.hpp"

namespace octurn {

Eigen::Isometry3d nominal_platform_from_camera() {
  Eigen::Isometry3d platform_from_camera = nominal_platform_from_sensor();  // the same rotation
  platform_from_camera.translation() << 0, -0.28, 0.18;
  return platform_from_camera;
}

Laser nominal_laser(std::string name, double azimuth) {
  const Eigen::Isometry3d platform_from_camera = nominal_platform_from_camera();
  const Eigen::Vector3d normal(std::cos(azimuth), std::sin(azimuth), 0);  // platform frame
  const Eigen::Vector3d source(0.35 * std::sin(azimuth), -0.35 * std::cos(azimuth), 0.25);
  return {.name = std::move(name),
          .normal = platform_from_camera.linear().transpose() * normal,
          .distance = -normal.dot(platform_from_camera.translation()),
          .source = platform_from_camera.inverse() * source};
}

Laser turned_in_holder(const Laser& laser, const Eigen::Vector3d& axis, double angle) {
  Laser turned = laser;
  turned.normal = Eigen::AngleAxisd(angle, axis) * laser.normal;
  turned.distance = turned.normal.dot(*laser.source);
  return turned;
}

}  // namespace octurn
