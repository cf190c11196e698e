#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "simulator/mesh.hpp"

namespace octurn {

/// A signed distance, metres, negative inside. Its magnitude is at most the distance to the
/// surface.
using SignedDistance = std::function<double(const Eigen::Vector3d&)>;

/// Meshes the surface where a signed distance is 0, by surface nets (Gibson 1998, "Constrained
/// elastic surface nets"): one vertex in each cell that the surface crosses, moved onto the
/// surface, and one quadrilateral around each crossed edge. Between vertices the mesh leaves the
/// surface by less than cell^2 / (4 r), r its radius of curvature.
///
/// @param bounds  holds the whole surface, metres
/// @param cell    side of a cell, metres
/// Deterministic. Cost grows with the surface, not with the box: cells far from it are skipped.
Mesh surface_net(const SignedDistance& distance, const Eigen::AlignedBox3d& bounds, double cell);

}  // namespace octurn
