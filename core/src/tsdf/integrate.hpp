#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "depth/condition_depth.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// Integrates one snapshot into the layers that a TSDF volume holds.
///
/// A voxel within the truncation of its pixel's tangent plane averages its distance to that plane,
/// by a weighted running mean (Curless and Levoy 1996, eq. 3-4). A voxel further in front of the
/// plane gets a vote for free space. The order of the snapshots changes only the rounding: of
/// weights to 1/4096 of their sum, of distances to a tick. The volume is traversed as a hierarchy
/// of cubes. Each is compared with the minimum and maximum depth of the pixels that it covers, so
/// that only voxels near the surface are sampled.
///
/// Deterministic: the same bits on x86-64 and arm64. O(pixels * truncation / voxel side).
///
/// @param volume  updated in place
/// @throws OutOfBudget  if not even one layer fits; some of the snapshot is then integrated
/// @throws Stopped  between two bricks
void integrate(TsdfVolume& volume, const ConditionedDepth& depth, const std::stop_token& stop = {});

/// Integrates several snapshots, in their order, by a team of threads. A thread takes a cube of
/// bricks and integrates all snapshots there, so that the number of threads changes no bit.
/// @param volume  that holds all its bricks (`TsdfVolume::holds_all`)
void integrate(TsdfVolume& volume, std::span<const ConditionedDepth* const> depths,
               ThreadTeam& team, const std::stop_token& stop = {});

/// Makes the observations of the snapshot with an index: one conditioned depth image, or several
/// for a scan by laser line. Called by several threads at once.
struct ConditionedSource {
  std::size_t count = 0;
  std::function<std::vector<ConditionedDepth>(std::size_t)> make = {};
};

/// Makes and integrates all snapshots of a scan, in their order, on several threads.
///
/// If the volume can hold all its bricks, as many snapshots as there are threads are conditioned in
/// parallel, then integrated in parallel. If it may have to drop layers, they are integrated one
/// after the other. The bits are the same.
///
/// @throws OutOfBudget, Stopped  and what the source throws
void integrate(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
               const std::stop_token& stop = {});

}  // namespace octurn
