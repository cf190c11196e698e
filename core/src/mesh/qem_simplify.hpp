#pragma once

#include <limits>
#include <span>
#include <stop_token>

#include "mesh/indexed_mesh.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// How far edge collapse may go.
struct CollapseLimits {
  double target_error = 0;                             ///< millimetres, RMS
  float min_z = std::numeric_limits<float>::lowest();  ///< millimetres: no vertex moves below
  float max_z = std::numeric_limits<float>::max();     ///< millimetres: no vertex moves above
};

/// Collapses edges of a mesh by quadric error metrics (QEM; Garland and Heckbert 1997).
///
/// Each collapse merges the quadrics of both ends and moves the vertex that is kept to their
/// optimum, if there `Quadric::mean_square` is at most the square of the target error. So the
/// distances from a vertex to the planes that it stands for have that RMS, weighted by area; the
/// largest of them has no bound. The cheapest go first, in a few passes of rising limits.
///
/// A collapse is refused if it would break the link condition (Dey, Edelsbrunner, Guha and
/// Nekhayev 1999), which keeps a manifold mesh manifold and of the same genus; if it would turn a
/// triangle's normal by more than 60 degrees; or if it would leave a sliver. Vertices on the
/// platform, z = 0, stay on it. Whether triangles far apart come to intersect is not looked at.
///
/// Deterministic: the same mesh gives the same bits on every processor, for any number of threads.
/// O(n) a pass.
///
/// @param mesh    updated in place: triangles are removed, the others keep their order; vertices
///                keep their indices, and those of no triangle are left to `compact`
/// @param locked  one per vertex: not 0 where it may neither move nor go, as on an open border
/// @param stop    looked at before each pass
/// @throws Stopped
void qem_simplify(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
                  const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
