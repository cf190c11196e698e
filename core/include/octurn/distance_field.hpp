#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/brick_map.hpp"
#include "octurn/octree.hpp"

namespace octurn {

/// What was seen of 8 x 8 x 8 leaves: a sample at the centre of each, x + 8 y + 64 z.
struct FieldBrick {
  static constexpr std::size_t samples = 512;
  std::array<std::int16_t, samples> distance = {};  // to the surface, positive outside, in ticks
  std::array<std::uint16_t, samples> weight = {};   // of what was averaged, in ticks
  std::array<std::uint8_t, samples> free = {};      // snapshots that saw through
};

/// How the leaves of a field lie: in bricks that cover the clip box, and a brick more on each side,
/// which stays empty; and in cells, the grain of free space. Bricks and cells are counted from the
/// lowest ones.
class FieldShape {
 public:
  static constexpr int ticks = 32000;  // of distance in a truncation

  /// @param side        of the root cube, metres
  /// @param levels      of the octree
  /// @param clip        metres, platform frame
  /// @param truncation  metres
  FieldShape(double side, int levels, const Box& clip, double truncation);

  double side() const { return side_; }
  int levels() const { return levels_; }
  double leaf_side() const { return leaf_side_; }
  double truncation() const { return truncation_; }

  /// The first brick, counted from the root's lowest corner, and how many there are on each axis.
  const Cell& low() const { return low_; }
  const Cell& size() const { return size_; }

  /// Leaves along a side of a cell: 2, 4 or 8.
  int cell_leaves() const { return cell_leaves_; }
  int cells_a_brick() const { return Brick::side / cell_leaves_; }

  /// The centre of a leaf counted from the root's lowest corner, metres, on one axis.
  double centre(int leaf, std::size_t axis) const {
    return (leaf + 0.5) * leaf_side_ - (axis < 2 ? side_ / 2 : 0.0);
  }

  /// All bricks, metres, platform frame.
  Box box() const;

  /// Whether a brick is one of those around the clip box.
  bool is_border(const Cell& brick) const {
    return brick.x == 0 || brick.y == 0 || brick.z == 0 || brick.x == size_.x - 1 ||
           brick.y == size_.y - 1 || brick.z == size_.z - 1;
  }

 protected:
  std::size_t brick_index(const Cell& brick) const {
    return static_cast<std::size_t>((brick.z * size_.y + brick.y) * size_.x + brick.x);
  }
  std::size_t cell_index(const Cell& cell) const {
    const int a_brick = cells_a_brick();
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y * a_brick) +
            static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(size_.x * a_brick) +
           static_cast<std::size_t>(cell.x);
  }
  std::size_t brick_count() const { return brick_index({0, 0, size_.z}); }
  std::size_t cell_count() const { return cell_index({0, 0, size_.z * cells_a_brick()}); }

 private:
  double side_;
  int levels_;
  double leaf_side_;
  double truncation_;
  int cell_leaves_;
  Cell low_ = {};
  Cell size_ = {};
};

/// A truncated signed distance field on the leaves of an octree, as snapshots see it: near a
/// surface samples in bricks, elsewhere cells that count how many snapshots saw through them.
///
/// Where not all of it fits in memory, it holds as many of its lowest layers of bricks as do.
class DistanceField : public FieldShape {
 public:
  static constexpr int weight_ticks = 1024;  // in a weight of one

  /// @param max_bytes   that it may take
  explicit DistanceField(const FieldShape& shape,
                         std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

  /// Those that it holds, counted from the lowest.
  const BrickLayers& layers() const { return layers_; }

  /// Forgets everything, to hold the layers from `low` on.
  void begin(int low, std::size_t max_bytes);

  /// A brick, if it exists.
  const FieldBrick* find(const Cell& brick) const { return bricks_.find(brick_index(brick)); }
  FieldBrick* find(const Cell& brick) { return bricks_.find(brick_index(brick)); }

  /// The same, made if it is missing. Where it does not fit, the field gives up its topmost layers;
  /// nothing if the brick is in one of those. @throws OctreeFull  if there is but one layer
  FieldBrick* make(const Cell& brick);

  /// How many snapshots saw through a cell.
  std::uint8_t& free_cell(const Cell& cell) { return free_[cell_index(cell)]; }
  std::uint8_t free_cell(const Cell& cell) const { return free_[cell_index(cell)]; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  void give_up_layers();

  std::size_t max_bytes_;
  BrickLayers layers_ = {};
  BrickMap<FieldBrick> bricks_;
  std::vector<std::uint8_t> free_;
};

}  // namespace octurn
