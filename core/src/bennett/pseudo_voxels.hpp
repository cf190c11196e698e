#pragma once

#include <array>
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

}  // namespace octurn
