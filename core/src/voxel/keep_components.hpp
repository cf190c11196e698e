#pragma once

#include <cstdint>
#include <stop_token>

#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The connected components (6-neighbours) that were removed from a mask, and their voxels.
struct DroppedComponents {
  std::uint64_t count = 0;
  std::uint64_t voxels = 0;
};

/// Keeps the largest connected component; the size of a standing one counts eightfold.
/// @param standing_layers  a component stands if it reaches into this many lowest layers of the box
/// @throws Stopped
DroppedComponents keep_main_component(VoxelMask& mask, int standing_layers = 1,
                                      const std::stop_token& stop = {});

/// Keeps the main component, and every other one that stands and has at least `min_voxels`.
/// @throws Stopped
DroppedComponents keep_standing_components(VoxelMask& mask, int standing_layers,
                                           std::uint64_t min_voxels,
                                           const std::stop_token& stop = {});

}  // namespace octurn
