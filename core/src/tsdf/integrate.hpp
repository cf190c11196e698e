#pragma once

#include <span>
#include <stop_token>

#include "depth/condition_depth.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// Integrates one snapshot into the layers that a TSDF volume holds.
///
/// A sample within the truncation of its pixel's tangent plane takes its distance to it, by a
/// weighted running mean (Curless and Levoy 1996, eq. 3-4); a sample further in front of it counts
/// as seen through. The order of the snapshots changes nothing but rounding: of weights to 1/4096
/// of their sum, of distances to a tick. The volume is descended as a hierarchy of cubes, each
/// compared with the minimum and maximum depth of the pixels that it covers, so that only voxels
/// near the surface are sampled.
///
/// Deterministic: the same bits on x86-64 and arm64. O(pixels * truncation / voxel side).
///
/// @param volume  updated in place
/// @throws OutOfBudget  if not even one layer fits; some of the snapshot is then integrated
/// @throws Stopped  between two bricks
void integrate(TsdfVolume& volume, const ConditionedDepth& depth, const std::stop_token& stop = {});

/// The same of several snapshots, in their order, by a team: each of its threads takes a cube of
/// bricks and integrates all of them there, so that their number changes no bit.
/// @param volume  that holds all its bricks (`TsdfVolume::holds_all`)
void integrate(TsdfVolume& volume, std::span<const ConditionedDepth* const> depths,
               ThreadTeam& team, const std::stop_token& stop = {});

}  // namespace octurn
