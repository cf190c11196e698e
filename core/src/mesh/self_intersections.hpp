#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace octurn {

/// A box along the axes, millimetres.
struct Aabb {
  std::array<float, 3> low = {};
  std::array<float, 3> high = {};

  void extend(const Aabb& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], other.low[i]);
      high[i] = std::max(high[i], other.high[i]);
    }
  }
  bool meets(const Aabb& other) const {
    return low[0] <= other.high[0] && other.low[0] <= high[0] && low[1] <= other.high[1] &&
           other.low[1] <= high[1] && low[2] <= other.high[2] && other.low[2] <= high[2];
  }
};

/// Where a manifold mesh cuts or touches itself: a box for each triangle that meets another other
/// than in the corners they share. What is closer than rounding could hide counts too.
///
/// @param vertices  positions, millimetres
/// @param known     so many of the first triangles are not looked at among themselves
std::vector<Aabb> self_intersections(std::span<const std::array<float, 3>> vertices,
                                     std::span<const MeshTriangle> triangles, std::size_t known);

}  // namespace octurn
