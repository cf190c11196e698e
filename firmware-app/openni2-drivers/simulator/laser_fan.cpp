#include "simulator/laser_fan.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace octurn {
namespace {

/// Intrinsics of a virtual camera at the laser's source, with one column in the laser's plane. Its
/// rows are rays of the fan, 0.2 mm apart at 0.35 m. Its fx only has to keep triangles larger than
/// the ones that `rasterise` drops as degenerate.
constexpr Intrinsics fan_column{
    .width = 1, .height = 4096, .fx = 1700, .fy = 1700, .cx = 0, .cy = 2047.5};

// 1/m, 0.3 mm at 0.35 m: surfaces must not shadow themselves.
constexpr double shadow_slack = 0.0025;

}  // namespace

LaserFan::LaserFan(const Laser& laser, const Eigen::Vector3d& target)
    : shadow_map_(static_cast<std::size_t>(fan_column.height), 0.0F) {
  const Eigen::Vector3d& source = *laser.source;
  const Eigen::Vector3d way = target - source;
  Eigen::Matrix3d axes;  // of the fan, as columns
  axes.col(0) = laser.normal;
  axes.col(2) = (way - laser.normal * laser.normal.dot(way)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  fan_from_sensor_.linear() = axes.transpose();
  fan_from_sensor_.translation() = -(axes.transpose() * source);
  fan_from_sensor_.makeAffine();
}

void LaserFan::add(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh) {
  rasterise(mesh, fan_from_sensor_ * sensor_from_mesh, fan_column, shadow_map_);
}

bool LaserFan::reaches(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = fan_from_sensor_ * point;
  const double row = fan_column.fy * seen.y() / seen.z() + fan_column.cy;
  if (!(seen.z() > 0) || !(row >= 0) || !(row < fan_column.height - 1)) {
    return false;
  }
  const auto above = static_cast<std::size_t>(row);
  return 1 / seen.z() + shadow_slack >=
         static_cast<double>(std::min(shadow_map_[above], shadow_map_[above + 1]));
}

}  // namespace octurn
