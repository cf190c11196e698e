#pragma once

#include "depth/depth_limits.hpp"

namespace octurn {

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
