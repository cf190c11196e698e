#pragma once

#include <stop_token>

#include "mesh/mesh.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/edited_sdf.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/shell.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// Marching cubes (Lorensen and Cline 1987): the surface between the voxels of a mask and those
/// around it, with vertices where the signed distance crosses zero, one layer of voxels at a time.
///
/// Closed and manifold for every pattern of signs (see `marching_cubes_cases`), free of
/// self-intersections, and with no two vertices so close that slicers meld them.
///
/// @param inside  the outermost voxels of its box are outside, except in its lowest layer
/// @throws Stopped  between two layers
void marching_cubes(const VoxelMask& inside, const HoleFilledSdf& sdf, const MeshSink& sink,
                    const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());
/// @param inside  without the voxels that edits removed
void marching_cubes(const VoxelMask& inside, const EditedSdf& sdf, const MeshSink& sink,
                    const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone());

/// A half-open range of cubes, each between eight voxels, by their lowest corners in a mask.
struct CubeRange {
  Index3 low = {};
  Index3 end = {};
};

/// The surface of a shell in some of the cubes of its mask, open at the border to the others.
/// Vertices on that border are `fixed`. The other side makes the same ones if the mask has two more
/// voxels on each side.
void marching_cubes(const VoxelMask& inside, const ShellField& shell, const CubeRange& range,
                    const MeshSink& sink, const std::stop_token& stop = {});

}  // namespace octurn
