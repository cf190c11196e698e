#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace octurn {

/// At most 300 cells of a grid that cover a set of points: few enough to be drawn on a page. Cells
/// begin with a side of 4 mm, which doubles whenever there are too many. The order of the points
/// has no influence.
class Places {
 public:
  static constexpr std::size_t max_count = 300;

  /// @param point  metres
  void add(const Eigen::Vector3d& point);

  /// Adds points spread over a facet, a cell's side apart.
  /// @param corners  metres
  void add(const std::array<Eigen::Vector3d, 3>& corners);

  /// Metres, sorted by x, then y, then z.
  std::vector<Eigen::Vector3d> centres() const;

 private:
  using Cell = std::array<int, 3>;

  double side_ = 0.004;  // metres
  std::set<Cell> cells_ = {};
};

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
