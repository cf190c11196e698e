#pragma once

#include <cstdint>
#include <stop_token>

#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The connected components (voxels that share faces) that a mask lost, and their voxels.
struct DroppedComponents {
  std::uint64_t count = 0;
  std::uint64_t voxels = 0;
};

/// Keeps one connected component: the largest, where those that stand count eightfold.
/// @param standing_layers  a component stands that reaches into so many of the box's lowest layers
/// @throws Stopped
DroppedComponents keep_main_component(VoxelMask& mask, int standing_layers = 1,
                                      const std::stop_token& stop = {});

/// Keeps that component and all others that stand and have at least so many voxels.
/// @throws Stopped
DroppedComponents keep_standing_components(VoxelMask& mask, int standing_layers,
                                           std::uint64_t min_voxels,
                                           const std::stop_token& stop = {});

}  // namespace octurn
