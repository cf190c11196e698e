#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "octurn/depth_frame.hpp"
#include "simulator/mesh.hpp"

namespace octurn {

/// The inverse of the depth of what each pixel sees first, 1/m, row by row; 0 where that is
/// nothing. Over a plane it is affine in u and v, which makes it what to interpolate, and to tell
/// readings from.
using InverseDepth = std::vector<float>;

/// Draws a mesh into the picture of a pinhole camera, in front of what is there behind it.
///
/// A pixel is covered if its centre, at whole u and v, is. Both sides of a triangle are drawn, so
/// that a mesh may be wound either way. What is nearer than 5 cm is cut off.
///
/// @param sensor_from_mesh  mesh's frame to optical frame, metres
/// @param picture           width x height of the intrinsics
void rasterise(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh,
               const Intrinsics& intrinsics, InverseDepth& picture);

}  // namespace octurn
