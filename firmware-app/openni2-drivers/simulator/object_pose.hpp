#pragma once

#include <Eigen/Geometry>

#include "simulator/mesh.hpp"

namespace octurn {

/// The pose of an object that a person has turned over: tipped about a horizontal axis, turned
/// about the platform's axis, moved a little off its centre, and touching its surface.
///
/// @param object  in its initial pose, in the platform's frame at angle 0, metres
/// @param pose    number of the pose; 0 is the initial one
Eigen::Isometry3d platform_from_object(const Mesh& object, int pose);

}  // namespace octurn
