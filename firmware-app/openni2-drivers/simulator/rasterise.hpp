#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "octurn/snapshot.hpp"
#include "simulator/mesh.hpp"

namespace octurn {

/// The inverse depth of the nearest surface at each pixel, 1/m, row by row; 0 where there is none.
/// Inverse depth is affine in u and v over a plane, and a Kinect's readings are affine in it.
using InverseDepth = std::vector<float>;

/// Draws a mesh into the picture of a pinhole camera. The nearer surface wins.
///
/// A pixel is covered if its centre, at whole u and v, is. Both sides of a triangle are drawn, so
/// that a mesh may be wound either way. Parts nearer than 5 cm are cut off.
///
/// @param sensor_from_mesh  mesh's frame to optical frame, metres
/// @param picture           width x height of the intrinsics
void rasterise(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh,
               const Intrinsics& intrinsics, InverseDepth& picture);

}  // namespace octurn
