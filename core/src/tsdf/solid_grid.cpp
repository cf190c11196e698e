#include "tsdf/solid_grid.hpp"

#include <algorithm>
#include <cmath>

#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

constexpr double min_truncation_voxels = 2.5;
constexpr double foot_room = 1.5;  // truncations below the platform of the first of several poses

}  // namespace

VoxelGrid make_solid_grid(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const double voxel_side = options.root_size / (1 << levels);
  const double distance = std::max(options.solid.truncation, min_truncation_voxels * voxel_side);
  // With several poses the surface of the foot may be seen from below: it needs room.
  const int below = options.placements.empty()
                        ? 0
                        : static_cast<int>(std::ceil(foot_room * distance /
                                                     (voxel_side * VoxelGrid::brick_side)));
  return {options.root_size, levels, options.clip, distance, below};
}

}  // namespace octurn
