#pragma once

#include "octurn/reconstruct.hpp"
#include "tsdf/voxel_grid.hpp"

namespace octurn {

/// The voxels of the method `solid`, with the truncation that they need.
VoxelGrid make_solid_grid(const ReconstructOptions& options);

}  // namespace octurn
