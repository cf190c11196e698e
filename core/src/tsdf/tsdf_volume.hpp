#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "octurn/box.hpp"
#include "voxel/brick_map.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// What was seen of 8 x 8 x 8 leaves: a sample at the centre of each, x + 8 y + 64 z.
struct TsdfBrick {
  static constexpr std::size_t samples = 512;
  std::array<std::int16_t, samples> distance = {};  // to the surface, positive outside, in ticks
  std::array<std::uint16_t, samples> weight = {};   // of what was averaged, in ticks
  std::array<std::uint8_t, samples> free = {};      // snapshots that saw through
};

/// How the leaves of a field lie: in bricks that cover the clip box, and a brick more on each side,
/// which stays empty; and in cells, the grain of free space. Bricks and cells are counted from the
/// lowest ones.
class VoxelGrid {
 public:
  static constexpr int ticks = 32000;  // of distance in a truncation

  /// @param side        of the root cube, metres
  /// @param levels      of the octree
  /// @param clip        metres, platform frame
  /// @param truncation  metres
  VoxelGrid(double side, int levels, const Box& clip, double truncation);

  double side() const { return side_; }
  int levels() const { return levels_; }
  double leaf_side() const { return leaf_side_; }
  double truncation() const { return truncation_; }

  /// The first brick, counted from the root's lowest corner, and how many there are on each axis.
  const Index3& low() const { return low_; }
  const Index3& size() const { return size_; }

  /// Leaves along a side of a cell: 2, 4 or 8.
  int block_voxels() const { return cell_leaves_; }
  int blocks_per_brick() const { return Brick::side / cell_leaves_; }

  /// The centre of a leaf counted from the root's lowest corner, metres, on one axis.
  double centre(int leaf, std::size_t axis) const {
    return (leaf + 0.5) * leaf_side_ - (axis < 2 ? side_ / 2 : 0.0);
  }

  /// All bricks, metres, platform frame.
  Box box() const;

  /// Whether a brick is one of those around the clip box.
  bool is_border(const Index3& brick) const {
    return brick.x == 0 || brick.y == 0 || brick.z == 0 || brick.x == size_.x - 1 ||
           brick.y == size_.y - 1 || brick.z == size_.z - 1;
  }

 protected:
  std::size_t brick_index(const Index3& brick) const {
    return static_cast<std::size_t>((brick.z * size_.y + brick.y) * size_.x + brick.x);
  }
  std::size_t cell_index(const Index3& cell) const {
    const int per_brick = blocks_per_brick();
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y * per_brick) +
            static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(size_.x * per_brick) +
           static_cast<std::size_t>(cell.x);
  }
  std::size_t brick_count() const { return brick_index({0, 0, size_.z}); }
  std::size_t cell_count() const { return cell_index({0, 0, size_.z * blocks_per_brick()}); }

 private:
  double side_;
  int levels_;
  double leaf_side_;
  double truncation_;
  int cell_leaves_;
  Index3 low_ = {};
  Index3 size_ = {};
};

/// A truncated signed distance field on the leaves of an octree, as snapshots see it: near a
/// surface samples in bricks, elsewhere cells that count how many snapshots saw through them.
///
/// Where not all of it fits in memory, it holds as many of its lowest layers of bricks as do.
class TsdfVolume : public VoxelGrid {
 public:
  static constexpr int weight_ticks = 1024;  // in a weight of one

  /// @param max_bytes   that it may take
  explicit TsdfVolume(const VoxelGrid& shape,
                      std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

  /// Those that it holds, counted from the lowest.
  const BrickLayers& layers() const { return layers_; }

  /// Forgets everything, to hold the layers from `low` on.
  void begin(int low, std::size_t max_bytes);

  /// A brick, if it exists.
  const TsdfBrick* find(const Index3& brick) const { return bricks_.find(brick_index(brick)); }
  TsdfBrick* find(const Index3& brick) { return bricks_.find(brick_index(brick)); }

  /// The same, made if it is missing. Where it does not fit, the field gives up its topmost layers;
  /// nothing if the brick is in one of those. @throws OutOfBudget  if there is but one layer
  TsdfBrick* make(const Index3& brick);

  /// How many snapshots saw through a cell.
  std::uint8_t& free_cell(const Index3& cell) { return free_[cell_index(cell)]; }
  std::uint8_t free_cell(const Index3& cell) const { return free_[cell_index(cell)]; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  void drop_top_layers();

  std::size_t max_bytes_;
  BrickLayers layers_ = {};
  BrickMap<TsdfBrick> bricks_;
  std::vector<std::uint8_t> free_;
};

}  // namespace octurn
