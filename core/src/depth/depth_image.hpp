#pragma once

#include <cstddef>
#include <vector>

namespace octurn {

/// A depth image in metres.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> z = {};  // row by row; 0 is no reading

  float at(int u, int v) const {
    return z[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(u)];
  }
  const float* row(int v) const { return &z[static_cast<std::size_t>(v * width)]; }
  float* row(int v) { return &z[static_cast<std::size_t>(v * width)]; }
};

/// Metres: neighbouring readings further apart lie on different surfaces.
inline constexpr float depth_step_limit = 0.008F;

}  // namespace octurn
