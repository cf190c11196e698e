#pragma once

#include <Eigen/Core>

namespace octurn {

/// Added before a cast to int, so that pixel coordinates from -1024 on are positive and the cast
/// rounds them down.
inline constexpr int pixel_bias = 1024;

/// The nearest pixels of coordinates from -1024 to 16384; -1 or less before the first.
inline Eigen::Array4i nearest_pixels(const Eigen::Array4f& at) {
  return (at + (pixel_bias + 0.5F)).cast<int>() - pixel_bias;
}

}  // namespace octurn
