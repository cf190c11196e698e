#pragma once

#include <stop_token>

#include "depth/condition_depth.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// Fuses one snapshot into the layers that a signed distance field holds.
///
/// A sample within the truncation of a pixel's tangent plane takes its distance to it, by a
/// weighted running mean (Curless and Levoy 1996, eq. 3-4); what lies in front of that is counted
/// as seen through. Nodes of the octree are met with the least and greatest depth of the pixels
/// they cover, so that only those near the surface are looked into.
///
/// @throws OutOfBudget  if not even one layer fits; some of the snapshot is then fused
/// @throws Stopped  between two bricks
void fuse(TsdfVolume& field, const ConditionedDepth& sighting, const std::stop_token& stop = {});

}  // namespace octurn
