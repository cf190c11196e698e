#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace octurn {

/// Calls `take` for points of a triangle at most `pitch` apart; for a small one, for its middle.
/// @param corners  metres
/// @param pitch    metres
template <typename Take>
void spread_points(const std::array<Eigen::Vector3d, 3>& corners, double pitch, Take take) {
  const Eigen::Vector3d along = corners[1] - corners[0];
  const Eigen::Vector3d across = corners[2] - corners[0];
  const double longest = std::sqrt(
      std::max({along.squaredNorm(), across.squaredNorm(), (across - along).squaredNorm()}));
  const int pieces = std::max(1, static_cast<int>(std::ceil(longest / pitch)));
  for (int i = 0; i < pieces; ++i) {
    for (int j = 0; i + j < pieces; ++j) {
      take(corners[0] + (i + 1.0 / 3) / pieces * along + (j + 1.0 / 3) / pieces * across);
    }
  }
}

}  // namespace octurn
