#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "laser/line_profile.hpp"

namespace octurn {

/// Where a camera and its lasers stand: what a calibration solves.
struct LaserRig {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  std::vector<Laser> lasers = {};
};

/// The unknowns of a small change of a rig. First those of the sensor's pose, in the platform
/// frame: rotation about x and y (radians), shift along x, y and z (metres); the turn about the
/// platform's axis is no unknown, as nothing tells it. Then three of each laser: its plane's turn
/// about the platform's Z and about the horizontal in it, both through the laser's pivot, and its
/// shift along its normal.
inline constexpr Eigen::Index pose_unknowns = 5;
inline constexpr Eigen::Index plane_unknowns = 3;

/// What each laser's plane turns about: the middle of what its line was seen on, optical frame.
using Pivots = std::vector<Eigen::Vector3d>;

/// The rig after a small change.
LaserRig moved(const LaserRig& rig, const Pivots& pivots, const Eigen::VectorXd& change);

/// A point that a rig sees, and how it moves with the unknowns.
class SeenPoint {
 public:
  /// @param laser  index of the one whose line the ray meets
  SeenPoint(const LaserRig& rig, const Pivots& pivots, std::size_t laser,
            const LineProfile::Ray& ray);

  const Eigen::Vector3d& in_platform() const { return in_platform_; }

  /// Adds, times `factor`, how the point's distance along a direction changes with each unknown.
  /// @param along  in the platform frame
  void add_row(const Eigen::Vector3d& along, double factor, Eigen::VectorXd& row) const;

 private:
  std::size_t laser_;
  Eigen::Vector3d in_platform_;
  Eigen::Vector3d ray_;             // in the platform frame's axes
  Eigen::Vector3d depth_per_unit_;  // of the plane's three unknowns: metres along the ray's z
};

}  // namespace octurn
