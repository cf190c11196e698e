#pragma once

#include <array>

#include "depth/condition_depth.hpp"
#include "depth/depth_limits.hpp"
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

/// `nearest_z` in the precision in which voxels are projected.
inline constexpr auto min_z = static_cast<float>(nearest_z);

/// Added before a cast to int, so that pixel coordinates from -1024 on are positive and the cast
/// rounds them down.
inline constexpr int pixel_bias = 1024;

/// The nearest pixel of a coordinate from -1024 to 16384; -1 or less before the first.
inline int nearest_pixel(float at) {
  return static_cast<int>(at + (pixel_bias + 0.5F)) - pixel_bias;
}

/// Minimum and maximum by value: those of the standard library return references, which GCC 12
/// chooses by a branch, and a loop with branches is not vectorised.
inline float smaller(float a, float b) { return b < a ? b : a; }
inline float larger(float a, float b) { return a < b ? b : a; }

}  // namespace octurn
