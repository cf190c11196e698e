#include "laser/laser_rig.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Derivatives of a plane's normal with respect to its two rotations.
struct PlaneTurns {
  Vector3d about_z;
  Vector3d about_level;

  PlaneTurns(const Eigen::Isometry3d& platform_from_sensor, const Vector3d& normal) {
    const Vector3d up = platform_from_sensor.linear().transpose() * Vector3d::UnitZ();
    about_z = up.cross(normal);
    about_level = normal.cross(up).normalized().cross(normal);
  }
};

}  // namespace

LaserRig moved(const LaserRig& rig, const Pivots& pivots, const Eigen::VectorXd& change) {
  LaserRig to = rig;
  const Vector3d rotation(change[0], change[1], 0);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (const double angle = rotation.norm(); angle > 0) {
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  motion.translation() = change.segment<3>(2);
  to.platform_from_sensor = motion * rig.platform_from_sensor;
  for (std::size_t i = 0; i < to.lasers.size(); ++i) {
    const auto first = pose_unknowns + plane_unknowns * static_cast<Eigen::Index>(i);
    Laser& laser = to.lasers[i];
    const PlaneTurns turns(rig.platform_from_sensor, laser.normal);
    const double shift = change[first + 2] + laser.distance - laser.normal.dot(pivots[i]);
    laser.normal =
        (laser.normal + change[first] * turns.about_z + change[first + 1] * turns.about_level)
            .normalized();
    laser.distance = laser.normal.dot(pivots[i]) + shift;
  }
  return to;
}

SeenPoint::SeenPoint(const LaserRig& rig, const Pivots& pivots, std::size_t laser,
                     const LineProfile::Ray& ray)
    : laser_(laser) {
  const Laser& of = rig.lasers[laser];
  const Vector3d point = meet(ray, of);
  const Vector3d along(static_cast<double>(ray.x), static_cast<double>(ray.y), 1);
  const PlaneTurns turns(rig.platform_from_sensor, of.normal);
  const Vector3d from_pivot = point - pivots[laser];
  // n . (z r) = d with d = n . pivot + shift: z changes by (shift - dn . (p - pivot)) / (n . r).
  const double across = of.normal.dot(along);
  depth_per_unit_ =
      Vector3d(-turns.about_z.dot(from_pivot), -turns.about_level.dot(from_pivot), 1) / across;
  in_platform_ = rig.platform_from_sensor * point;
  ray_ = rig.platform_from_sensor.linear() * along;
}

void SeenPoint::add_row(const Vector3d& along, double factor, Eigen::VectorXd& row) const {
  const Vector3d turning = in_platform_.cross(along);
  row[0] += factor * turning.x();
  row[1] += factor * turning.y();
  row.segment<3>(2) += factor * along;
  const auto first = pose_unknowns + plane_unknowns * static_cast<Eigen::Index>(laser_);
  row.segment<3>(first) += factor * along.dot(ray_) * depth_per_unit_;
}

}  // namespace octurn
