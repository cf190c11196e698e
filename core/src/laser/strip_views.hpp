#pragma once

#include <vector>

#include "depth/condition_depth.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Renders a snapshot's strips from the camera, and from each laser whose source is known. Each ray
/// is free up to the surface.
///
/// Of the surface between two lines, a stop's views show the half nearer to its own line, where
/// their rays nearly coincide with the path of the light. Nothing is smoothed: the triangles of a
/// strip are its tangent planes.
///
/// @param clip       metres, object's frame: outside it strips make no surface, but show free space
/// @param placement  of one of several poses; null for one pose
std::vector<ConditionedDepth> strip_views(const Snapshot& snapshot, const Box& clip,
                                          const Placement* placement);

}  // namespace octurn
