#pragma once

#include "octurn/reconstruct.hpp"
#include "tsdf/voxel_grid.hpp"

namespace octurn {

/// The voxel grid of the method `solid`, with its truncation.
VoxelGrid make_solid_grid(const ReconstructOptions& options);

}  // namespace octurn
