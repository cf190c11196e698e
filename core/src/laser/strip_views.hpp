#pragma once

#include <vector>

#include "depth/condition_depth.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A snapshot's strips as the camera sees them, and as the laser does whose place is told: each ray
/// is free up to the surface.
///
/// Of the surface between two lines each stop's views show the half that is nearer to its own line,
/// as there its rays are nearly those that the light took. Nothing is smoothed: a strip's triangles
/// are its tangent planes.
///
/// @param clip       metres, object's frame: outside it strips make no surface, but show free space
/// @param placement  of one of several poses; null for one pose
std::vector<ConditionedDepth> strip_views(const Snapshot& snapshot, const Box& clip,
                                          const Placement* placement);

}  // namespace octurn
