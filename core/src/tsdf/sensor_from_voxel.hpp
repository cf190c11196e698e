#pragma once

#include <array>

#include "depth/condition_depth.hpp"
#include "tsdf/voxel_grid.hpp"

namespace octurn {

/// The affine map from voxel coordinates, counted from the grid's lowest corner, to the sensor's
/// frame, metres. Sums are taken in one order, so that all processors get the same bits.
struct SensorFromVoxel {
  using Vector = std::array<float, 3>;

  SensorFromVoxel(const VoxelGrid& grid, const ConditionedDepth& depth);

  Vector operator()(float x, float y, float z) const {
    Vector point{};
    for (std::size_t i = 0; i < 3; ++i) {
      point[i] = origin[i] + x * step[0][i] + y * step[1][i] + z * step[2][i];
    }
    return point;
  }

  Vector origin = {};               // of the grid's lowest corner
  std::array<Vector, 3> step = {};  // over one voxel along each axis
};

}  // namespace octurn
