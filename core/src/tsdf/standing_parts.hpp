#pragma once

#include <cstdint>
#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "voxel/connected_components.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The components of an SDF's inside that stand on the platform.
struct StandingParts {
  VoxelMask mask;
  DroppedComponents dropped = {};
};

/// The number of voxels of the smallest component that is a part and no crumb.
std::uint64_t min_part_voxels(const HoleFilledSdf& sdf);

/// The connected components of the inside that the model keeps.
///
/// A component that ends just above the platform counts as standing, because the space right below
/// an overhang is hardly seen. If no component reaches the platform, such a component is extended
/// down to it in the columns through which no ray passed.
/// @throws Stopped
StandingParts standing_parts(const HoleFilledSdf& sdf, Parts parts,
                             const std::stop_token& stop = {},
                             ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
