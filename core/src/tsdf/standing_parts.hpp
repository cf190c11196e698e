#pragma once

#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "voxel/keep_components.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// What stands on the platform, of what an SDF has inside.
struct StandingParts {
  VoxelMask mask;
  DroppedComponents dropped = {};
};

/// The connected components of the inside that the model keeps.
///
/// One that ends just above the platform stands on it: what is right below an overhang is hardly
/// seen. Where nothing else does, its foot is what no ray passed through, straight down to the
/// platform.
/// @throws Stopped
StandingParts standing_parts(const HoleFilledSdf& sdf, Parts parts,
                             const std::stop_token& stop = {});

}  // namespace octurn
