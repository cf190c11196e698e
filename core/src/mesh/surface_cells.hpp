#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstddef>
#include <optional>
#include <vector>

namespace octurn {

/// The cells of a grid that a surface passes through, one bit each. Cells begin with a side of
/// 4 mm, which doubles when there are more than `max_bricks` bricks of 8 x 8 x 8. The order in
/// which points and facets are added has no influence.
class SurfaceCells {
 public:
  static constexpr std::size_t max_bricks = 2048;  // some 250 kB; an object of 28 cm has 500

  /// @param point  metres
  void add(const Eigen::Vector3d& point);

  /// Adds points spread over a facet, a cell's side apart.
  /// @param corners  metres
  void add(const std::array<Eigen::Vector3d, 3>& corners);

  /// Whether a cell of the surface is within a distance.
  /// @param point     metres
  /// @param distance  metres, not negative
  bool has_near(const Eigen::Vector3d& point, double distance) const;

  bool empty() const { return bricks_.empty(); }

 private:
  using Cell = std::array<int, 3>;
  using Brick = std::bitset<512>;

  struct PlacedBrick {
    Cell place = {};
    Brick cells = {};
  };

  /// The first brick that is not before a place.
  std::vector<PlacedBrick>::const_iterator lower_bound(const Cell& place) const;
  bool has(const Cell& cell) const;
  void set(const Cell& cell);
  void make_coarser();

  double side_ = 0.004;                   // metres
  std::vector<PlacedBrick> bricks_ = {};  // sorted by their places
  std::optional<Cell> last_ = {};         // added last: the next point is often in the same cell
};

}  // namespace octurn
