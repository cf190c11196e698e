#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxel/octree.hpp"

namespace octurn {

/// A brick and its position, counted in bricks.
struct PlacedBrick {
  Index3 position = {};
  const Brick* brick = nullptr;
};

/// The 8 x 8 x 8 pseudo-voxels whose lowest corners are the leaves of one brick position, and the
/// up to eight bricks that hold their corners: bit 0 of the index is one brick on in x, bit 1 in y,
/// bit 2 in z.
struct PseudoVoxelBrick {
  Index3 position = {};
  std::array<const Brick*, 8> bricks = {};
};

class CornerBricks;

/// The pseudo-voxel bricks of one layer that have at least one occupied corner.
class PseudoVoxelLayer {
 public:
  /// @param bricks  those of the layer, then those of the layer above; each must outlive this
  PseudoVoxelLayer(int layer, std::vector<PlacedBrick> bricks);

  const std::vector<PseudoVoxelBrick>& bricks() const { return bricks_; }

  /// Sorts them by y, then by x.
  void sort_by_rows();

 private:
  void add(const CornerBricks& bricks, const Index3& position, int corner);

  std::vector<PseudoVoxelBrick> bricks_ = {};
};

/// The first layer of pseudo-voxels of a slab. At the root's bottom it is the layer below the root,
/// in which the surface is closed.
inline int first_layer(const BrickLayers& slab) { return slab.low == 0 ? -1 : slab.low; }

/// The pseudo-voxel bricks of a layer of an octree, which needs the layer's leaves and the lowest
/// ones of the layer above.
PseudoVoxelLayer pseudo_voxels(const Octree& octree, int layer);

/// The corners (x, y) = (0, 0), (1, 0), (0, 1), (1, 1) of 8 x 8 pseudo-voxels on one layer of
/// leaves.
using CornerLayer = std::array<std::uint64_t, 4>;

/// @param bricks  the four that meet along z
inline CornerLayer corner_layer(const std::array<const Brick*, 4>& bricks, std::size_t z) {
  constexpr std::uint64_t first_column = 0x0101010101010101;
  const auto shifted_x = [](std::uint64_t row, std::uint64_t next) {
    return (row >> 1 & ~(first_column << 7)) | (next & first_column) << 7;
  };
  const auto shifted_y = [](std::uint64_t layer, std::uint64_t next) {
    return layer >> 8 | next << 56;
  };
  const std::uint64_t here = bricks[0]->layers[z];
  const std::uint64_t right = bricks[1]->layers[z];
  const std::uint64_t behind = bricks[2]->layers[z];
  const std::uint64_t across = bricks[3]->layers[z];
  const std::uint64_t x = shifted_x(here, right);
  return {here, x, shifted_y(here, behind), shifted_y(x, shifted_x(behind, across))};
}

/// Calls `visit(x, y, z, pattern)` for the pseudo-voxels of a pseudo-voxel brick that the surface
/// crosses.
template <typename Visit>
void for_each_mixed(const PseudoVoxelBrick& brick, Visit visit) {
  const std::array<const Brick*, 4> lower{brick.bricks[0], brick.bricks[1], brick.bricks[2],
                                          brick.bricks[3]};
  const std::array<const Brick*, 4> upper{brick.bricks[4], brick.bricks[5], brick.bricks[6],
                                          brick.bricks[7]};
  CornerLayer above = corner_layer(lower, 0);
  for (int z = 0; z < Brick::side; ++z) {
    const CornerLayer below = above;
    above = z + 1 < Brick::side ? corner_layer(lower, static_cast<std::size_t>(z + 1))
                                : corner_layer(upper, 0);
    const std::uint64_t any =
        below[0] | below[1] | below[2] | below[3] | above[0] | above[1] | above[2] | above[3];
    const std::uint64_t all =
        below[0] & below[1] & below[2] & below[3] & above[0] & above[1] & above[2] & above[3];
    for (std::uint64_t mixed = any & ~all; mixed != 0; mixed &= mixed - 1) {
      const int bit = std::countr_zero(mixed);
      std::size_t pattern = 0;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        pattern |= (below[corner] >> bit & 1) << corner | (above[corner] >> bit & 1)
                                                              << (corner + 4);
      }
      visit(bit % Brick::side, bit / Brick::side, z, pattern);
    }
  }
}

}  // namespace octurn
