#pragma once

#include <span>
#include <stop_token>

#include "parallel/thread_team.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/laplace_fill.hpp"
#include "tsdf/platform_cut.hpp"

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

/// A block is known if a quarter of its voxels is, or a ray passed through all of it. Blocks of the
/// grid's border are free.
///
/// Below the platform of one pose, what another pose saw to be free is unknown: a foot that neither
/// saw stood right on that platform, and free space under it would be extended into the foot.
///
/// @param base_layer  the lowest layer of voxels that counts
/// @param platforms   of several poses
/// @throws Stopped
KnownBlocks known_blocks(const CompactTsdf& known, int base_layer,
                         std::span<const PlatformCut> platforms = {},
                         const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
