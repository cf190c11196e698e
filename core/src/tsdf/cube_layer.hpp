#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The cubes between two layers of a mask's voxels that its surface crosses.
struct CubeLayer {
  struct Cube {
    int x = 0;  ///< of the lowest corner
    int y = 0;
    std::uint8_t pattern = 0;  ///< a bit for each corner that is inside, as in marching_cubes_cases
  };
  std::vector<Cube> mixed = {};  ///< row by row
  /// For each cube, row by row, 1 if it is of a case whose triangles could intersect; empty if none
  /// is.
  std::vector<std::uint8_t> ambiguous = {};
};

/// The cubes between the layers z and z + 1 of a mask. Voxels outside the mask are outside the
/// object.
CubeLayer mixed_cubes(const VoxelMask& inside, int z);

}  // namespace octurn
