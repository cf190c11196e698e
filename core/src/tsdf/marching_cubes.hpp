#pragma once

#include <stop_token>

#include "mesh/mesh.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The surface between the leaves of a set and those around it, with its vertices where the field
/// crosses zero; a layer of leaves at a time.
///
/// Closed and manifold whatever the signs are (see `marching_cubes_cases`), without cuts through
/// itself, and with no two vertices closer than slicers meld. Leaves on the sides of the set's box
/// must be empty, but for its lowest layer.
///
/// @throws Stopped  between two layers
void marching_cubes(const VoxelMask& inside, const HoleFilledSdf& field, const MeshSink& sink,
                    const std::stop_token& stop = {});

}  // namespace octurn
