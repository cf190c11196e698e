#pragma once

#include <limits>
#include <span>
#include <stop_token>

#include "mesh/indexed_mesh.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Limits of edge collapse.
struct CollapseLimits {
  double target_error = 0;                             ///< millimetres, RMS
  float min_z = std::numeric_limits<float>::lowest();  ///< millimetres: no vertex moves below
  float max_z = std::numeric_limits<float>::max();     ///< millimetres: no vertex moves above
};

/// Collapses edges of a mesh by quadric error metrics (QEM; Garland and Heckbert 1997).
///
/// Each collapse merges the quadrics of both ends and moves the vertex that is kept to their
/// optimum, if `Quadric::mean_square` there is at most the square of the target error. The target
/// therefore bounds the RMS distance, weighted by area, from a vertex to the planes of the
/// triangles that it replaces, but not their maximum distance. The cheapest edges go first, in a
/// few passes of rising limits.
///
/// A collapse is refused if it would break the link condition (Dey, Edelsbrunner, Guha and
/// Nekhayev 1999), which keeps a manifold mesh manifold and of the same genus; if it would turn a
/// triangle's normal by more than 60 degrees; or if it would leave a sliver. Vertices on the
/// platform, z = 0, stay on it. Intersections of triangles that are not neighbours are not checked.
///
/// Deterministic: the same mesh gives the same bits on every processor, for any number of threads.
/// O(n) a pass.
///
/// @param mesh    updated in place: triangles are removed, the others keep their order; vertices
///                keep their indices, and `compact` removes those without a triangle
/// @param locked  one per vertex: not 0 if it may neither move nor be removed, as on an open border
/// @param stop    checked before each pass
/// @throws Stopped
void qem_simplify(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
                  const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
