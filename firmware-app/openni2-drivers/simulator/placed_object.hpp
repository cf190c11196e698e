#pragma once

#include <Eigen/Geometry>
#include <string>

#include "simulator/mesh.hpp"

namespace octurn {

/// The object on a simulated platform.
class PlacedObject {
 public:
  /// @param mesh  in the platform's frame at angle 0, metres
  explicit PlacedObject(Mesh mesh);

  const Mesh& mesh() const { return mesh_; }

  /// Turns the object over. @param pose  as of `platform_from_object`
  /// @return false if it has this pose already
  bool set_pose(int pose);

  /// @param angle  of the platform, radians, counter-clockwise seen from above
  Eigen::Isometry3d platform_from_mesh(double angle) const;

 private:
  Mesh mesh_;
  int pose_ = 0;  // number of the current pose
  Eigen::Isometry3d platform_from_object_ = Eigen::Isometry3d::Identity();
};

/// Reads the object of a simulated rig and places it on the platform.
/// @param mesh_file  STL in millimetres, Z up; empty: the simulator's own object
/// @throws Error "mesh-malformed"
Mesh told_object(const std::string& mesh_file);

/// The pose of an object that a person has turned over: tipped about a horizontal axis, turned
/// about the platform's axis, moved a little off its centre, and touching its surface.
///
/// @param object  in its initial pose, in the platform's frame at angle 0, metres
/// @param pose    number of the pose; 0 is the initial one
Eigen::Isometry3d platform_from_object(const Mesh& object, int pose);

}  // namespace octurn
