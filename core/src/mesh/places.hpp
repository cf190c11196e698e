#pragma once

#include <Eigen/Core>
#include <array>
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

}  // namespace octurn
