#pragma once

#include <Eigen/Geometry>

#include "octurn/scan_folder.hpp"
#include "simulator/rasterise.hpp"

namespace octurn {

/// The light of a line laser: a fan in its plane, 100 degrees wide, and what it meets first.
class LaserFan {
 public:
  /// @param laser   with its source
  /// @param target  that the fan's middle is turned to, metres, the laser's frame
  LaserFan(const Laser& laser, const Eigen::Vector3d& target);

  /// Has the light meet a mesh beside what it meets already.
  /// @param sensor_from_mesh  mesh's frame to the laser's frame, metres
  void add(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh);

  /// Whether light of the fan gets as far as a point in its plane, metres, the laser's frame.
  bool reaches(const Eigen::Vector3d& point) const;

 private:
  Eigen::Isometry3d fan_from_sensor_;  // X across the plane, Z to the target
  InverseDepth met_;                   // along each ray of the fan
};

}  // namespace octurn
