#pragma once

#include <span>
#include <stop_token>

#include "parallel/thread_team.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/laplace_fill.hpp"
#include "tsdf/voxel_grid.hpp"

namespace octurn {

/// The mean signed distances of the blocks in a box of bricks, where they are known.
struct KnownBlocks {
  /// Half-open box of bricks: those that exist and one around them, without the layer below the
  /// platform. Empty if there is no brick.
  Index3 low = {};
  Index3 end = {};
  /// Ticks, positive outside; indexed from the box's lowest block.
  PartialGrid distances = {};
};

/// A block is known if a quarter of its voxels are known, or if rays passed through all of it.
/// Blocks in the grid's border are free.
///
/// Free space of one pose below the platform of another counts as unknown: a foot that neither pose
/// saw stood on that platform, and the fill would extend the free space into it.
///
/// @param base_layer  the lowest layer of voxels that counts
/// @param platforms   of several poses; empty for one
/// @throws Stopped
KnownBlocks known_blocks(const CompactTsdf& known, int base_layer,
                         std::span<const PlatformCut> platforms = {},
                         const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());

/// Makes unknown blocks free that lie more than `max_bulge` metres outside the convex hull of what
/// was observed: where nothing was measured at all, the fill would swell up to the next free space.
///
/// The hull is approximated from outside, by planes of 26 directions (a k-DOP; Klosowski et al.
/// 1998). Of the observed blocks, one in a thousand may lie outside in each direction: stray
/// readings would stretch it.
void limit_bulges(KnownBlocks& blocks, const VoxelGrid& grid, double max_bulge);

}  // namespace octurn
