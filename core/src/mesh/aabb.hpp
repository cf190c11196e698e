#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace octurn {

/// Axis-aligned bounding box, millimetres; closed.
struct Aabb {
  std::array<float, 3> min = {};
  std::array<float, 3> max = {};

  void extend(const Aabb& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], other.min[i]);
      max[i] = std::max(max[i], other.max[i]);
    }
  }

  /// Whether the boxes have a point in common.
  bool overlaps(const Aabb& other) const {
    return min[0] <= other.max[0] && other.min[0] <= max[0] && min[1] <= other.max[1] &&
           other.min[1] <= max[1] && min[2] <= other.max[2] && other.min[2] <= max[2];
  }
};

}  // namespace octurn
