#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "bennett/voxelize_triangle.hpp"
#include "octurn/tiles.hpp"
#include "voxel/index3.hpp"

namespace octurn {

/// A point in half-units of a `TileLattice`, counted from the lowest corner of tile (0, 0, 0).
using LatticePoint = std::array<std::int64_t, 3>;

/// The lattice of the leaves (voxels for `solid`) of all tiles, counted from the lowest corner of
/// tile (0, 0, 0). It does not depend on the tiles' side, so that root cubes of another side have
/// the same leaves.
class TileLattice {
 public:
  /// Maximum number of tiles on each side of the first; points beyond are dropped.
  static constexpr int max_index = 10'000;

  /// @throws Error "bad-settings"  if an option is out of its range
  explicit TileLattice(const ReconstructOptions& options);

  double root_side() const { return root_side_; }  ///< metres
  double leaf_side() const { return leaf_side_; }  ///< metres
  int levels() const { return levels_; }
  int leaves_per_side() const { return 1 << levels_; }                     ///< of a tile
  int bricks_per_side() const { return leaves_per_side() / Brick::side; }  ///< of a tile
  int leaf_bits() const { return leaf_bits_; }  ///< a leaf has 2^leaf_bits half-units

  /// Snaps a point (metres) to the centre of its unit, as a `SnapGrid` does: 2^7 units a leaf, or
  /// fewer where a tile has more than 2^11 leaves a side. Coordinate 0 is z = 0 on the vertical
  /// axis; on the others x = 0 and y = 0 are in the middle of a tile.
  /// @return nothing for `no_point`, or beyond the last tile
  std::optional<LatticePoint> snap(const Eigen::Vector3f& point) const;

  /// The leaf that contains a coordinate, and the tile that contains a leaf, on any axis.
  std::int64_t leaf_at(std::int64_t half_units) const { return half_units >> leaf_bits_; }
  int tile_at(std::int64_t leaf) const { return static_cast<int>(leaf >> levels_); }

  /// The origin of a tile's frame, in which the tile is the root cube: metres, object's frame.
  Eigen::Vector3d origin(const TileIndex& tile) const {
    return root_side_ * Eigen::Vector3d(tile.x, tile.y, tile.z);
  }

  /// Converts a point to the frame of a tile, half-units.
  SnapPoint in_tile(const LatticePoint& point, const TileIndex& tile) const {
    const int bits = leaf_bits_ + levels_;
    const auto moved = [&](std::size_t axis, int index) {
      return static_cast<std::int32_t>(point[axis] - (std::int64_t{index} << bits));
    };
    return {moved(0, tile.x), moved(1, tile.y), moved(2, tile.z)};
  }

 private:
  double root_side_;
  int levels_;
  double leaf_side_;
  int leaf_bits_;
  double units_per_metre_;
};

}  // namespace octurn
