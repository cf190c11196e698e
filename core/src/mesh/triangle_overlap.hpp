#pragma once

#include <array>
#include <span>

#include "mesh/mesh.hpp"
#include "mesh/vector3.hpp"

namespace octurn {

/// The cone that a triangle fills seen from one of its corners: two sides, and their normal.
struct Sector {
  Vector3 first;
  Vector3 second;
  Vector3 normal = cross(first, second);
};

/// Whether two triangles intersect only in the vertices or the side that they share.
///
/// Conservative: false if the answer depends on rounding. Triangles without a common vertex must be
/// 1e-7 mm apart along a separating axis; those with one must diverge by an angle of 1e-9.
/// Positions are single precision numbers, 1e-5 mm apart at the size of a model, so that real gaps
/// are wider. A triangle without area is never disjoint from one that shares vertices with it.
///
/// @param vertices  positions, millimetres
bool are_disjoint(std::span<const std::array<float, 3>> vertices, const MeshTriangle& a,
                  const MeshTriangle& b);

}  // namespace octurn
