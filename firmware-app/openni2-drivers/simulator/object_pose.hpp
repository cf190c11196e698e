#pragma once

#include <Eigen/Geometry>

#include "simulator/mesh.hpp"

namespace octurn {

/// Where an object lies that a person has turned over: tipped by more than a right angle, turned
/// about the platform's axis, a little aside of its centre, and touching its surface.
///
/// @param object  as it stands at first, in the platform's frame at angle 0, metres
/// @param pose    which way: each number another one; 0: as it stands at first
Eigen::Isometry3d platform_from_object(const Mesh& object, int pose);

}  // namespace octurn
