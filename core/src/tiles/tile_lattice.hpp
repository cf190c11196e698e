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

/// The leaves (voxels for `solid`) of all tiles, counted from the lowest corner of tile (0, 0, 0):
/// one lattice whatever the tiles' side, so that root cubes of another side have the same leaves.
class TileLattice {
 public:
  /// Tiles on each side of the first: what lies beyond is left out.
  static constexpr int max_index = 10'000;

  /// @throws Error "bad-settings"  if an option is out of its range
  explicit TileLattice(const ReconstructOptions& options);

  double root_side() const { return root_side_; }  ///< metres
  double leaf_side() const { return leaf_side_; }  ///< metres
  int levels() const { return levels_; }
  int leaves_per_side() const { return 1 << levels_; }                     ///< of a tile
  int bricks_per_side() const { return leaves_per_side() / Brick::side; }  ///< of a tile
  int leaf_bits() const { return leaf_bits_; }  ///< a leaf is so many halvings of it in half-units

  /// The lattice's coordinate of z = 0 is 0; of x = 0 and y = 0 it is the middle of a tile.
  /// Corners of triangles are snapped to the middles of units, as in a `SnapGrid`: 2^7 units a
  /// leaf, or fewer where a tile has more than 2^11 leaves a side.
  /// @return nothing if it is `no_point` or lies beyond the last tile
  std::optional<LatticePoint> snap(const Eigen::Vector3f& point) const;

  /// The tile and, in it, the brick of a leaf; the coordinates of a leaf on all axes likewise.
  std::int64_t leaf_at(std::int64_t half_units) const { return half_units >> leaf_bits_; }
  int tile_at(std::int64_t leaf) const { return static_cast<int>(leaf >> levels_); }

  /// Metres: how far a tile's frame, in which it is the root cube, is moved from the object's.
  Eigen::Vector3d origin(const TileIndex& tile) const {
    return root_side_ * Eigen::Vector3d(tile.x, tile.y, tile.z);
  }

  /// The same point in the frame of a tile, half-units.
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
