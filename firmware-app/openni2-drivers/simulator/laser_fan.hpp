#pragma once

#include <Eigen/Geometry>

#include "octurn/scan_folder.hpp"
#include "simulator/rasterise.hpp"

namespace octurn {

/// The light of a line laser: a fan in its plane, 100 degrees wide, and its shadow map.
class LaserFan {
 public:
  /// @param laser   has a source
  /// @param target  point at which the fan's middle is aimed, metres, the laser's frame
  LaserFan(const Laser& laser, const Eigen::Vector3d& target);

  /// Adds a mesh that stops the light.
  /// @param sensor_from_mesh  mesh's frame to the laser's frame, metres
  void add(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh);

  /// Whether the light reaches a point in the laser's plane, metres, the laser's frame.
  bool reaches(const Eigen::Vector3d& point) const;

 private:
  Eigen::Isometry3d fan_from_sensor_;  // X across the plane, Z to the target
  InverseDepth shadow_map_;            // of the first surface along each ray of the fan
};

}  // namespace octurn
