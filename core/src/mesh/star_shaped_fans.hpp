#pragma once

#include <array>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Finds the vertices whose triangles provably meet only in the spokes that they share, so that no
/// pair of those triangles has to be tested.
///
/// Proof. Project the fan of a vertex along the sum of its normals. No triangle is turned over, and
/// each spoke is left by exactly one triangle and met by exactly one other; so the fan winds round
/// the vertex in full turns. If its winding number is 1, the projections are sectors that do not
/// overlap: the fan is star-shaped. What is disjoint in projection is disjoint.
///
/// Conservative: 0 if rounding could matter. O(vertices + triangles).
///
/// @param vertices  positions, millimetres
/// @returns one per vertex: 1 if its fan is star-shaped, otherwise 0
std::vector<char> find_star_shaped_fans(std::span<const std::array<float, 3>> vertices,
                                        std::span<const MeshTriangle> triangles,
                                        ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
