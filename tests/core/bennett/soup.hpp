#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "bennett/voxelize_triangle.hpp"
#include "support/random.hpp"

namespace octurn {

/// Random triangles of all kinds that are hard to voxelize exactly: tiny and huge ones, degenerate
/// ones, with corners next to leaf faces, partly and wholly outside the root.
class Soup {
 public:
  Soup(std::uint32_t seed, int levels) : random_(seed), leaf_(1 << (SnapGrid::bits - levels)) {}

  std::array<SnapPoint, 3> triangle() {
    constexpr int root = 1 << SnapGrid::bits;
    const std::array<int, 4> reaches{leaf_ / 4 + 2, 2 * leaf_, 8 * leaf_, root};
    const int reach = reaches[static_cast<std::size_t>(between(0, 3))];
    const bool may_leave = between(0, 3) == 0;
    const int low = may_leave ? -root : 0;
    const int high = may_leave ? 2 * root : root;
    const SnapPoint middle{between(low, high - 1), between(low, high - 1), between(low, high - 1)};
    std::array<SnapPoint, 3> corners{};
    for (SnapPoint& corner : corners) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        int at = middle[axis] + between(-reach, reach);
        if (between(0, 3) == 0) {
          at = (at / leaf_) * leaf_ + (between(0, 1) == 0 ? 1 : -1);  // beside a face
        }
        if (between(0, 9) == 0) {
          at = middle[axis];  // makes edges parallel to an axis, and edges of length 0
        }
        corner[axis] = std::clamp(at, low, high - 1) | 1;
      }
    }
    if (between(0, 15) == 0) {
      corners[2] = corners[1];
    }
    return corners;
  }

  int between(int low, int high) { return random_.between(low, high); }

 private:
  Random random_;
  int leaf_;
};

}  // namespace octurn
