#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/vector3.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Finds the self-intersections of a mesh: the box of each triangle that meets another elsewhere
/// than in the vertices that they share.
///
/// Conservative: gaps that rounding could hide count as contact (see `are_disjoint`). Candidate
/// pairs come from a bounding volume hierarchy; pairs in a star-shaped fan are skipped. O(n log n)
/// for a surface whose triangles are of similar size. Deterministic but for their order.
///
/// @param vertices         positions, millimetres
/// @param already_checked  pairs among so many leading triangles are not tested
/// @returns two boxes for each pair, in no particular order; a box may come more than once
std::vector<Aabb> self_intersections(std::span<const std::array<float, 3>> vertices,
                                     std::span<const MeshTriangle> triangles,
                                     std::size_t already_checked,
                                     ThreadTeam& team = ThreadTeam::alone());

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
