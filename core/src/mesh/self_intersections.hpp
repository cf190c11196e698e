#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mesh/aabb.hpp"
#include "mesh/mesh.hpp"
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

}  // namespace octurn
