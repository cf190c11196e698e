#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/octree.hpp"
#include "octurn/pool.hpp"

namespace octurn {

/// What was seen of 8 x 8 x 8 leaves: a sample at the centre of each, x + 8 y + 64 z.
struct FieldBrick {
  static constexpr std::size_t samples = 512;
  std::array<std::int16_t, samples> distance = {};  // to the surface, positive outside, in ticks
  std::array<std::uint16_t, samples> weight = {};   // of what was averaged, in ticks
  std::array<std::uint8_t, samples> free = {};      // snapshots that saw through
};

/// A truncated signed distance field on the leaves of an octree, as snapshots see it: near a
/// surface samples in bricks, elsewhere cells that count how many snapshots saw through them.
///
/// It covers the clip box, in whole bricks, and a brick more on each side, which stays empty.
class DistanceField {
 public:
  static constexpr int ticks = 32000;        // of distance in a truncation
  static constexpr int weight_ticks = 1024;  // in a weight of one
  static constexpr std::size_t cell_samples_most = 8;

  /// @param side        of the root cube, metres
  /// @param levels      of the octree
  /// @param clip        metres, platform frame
  /// @param truncation  metres
  /// @param max_bytes   that its bricks may take
  DistanceField(double side, int levels, const Box& clip, double truncation,
                std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

  double side() const { return side_; }
  int levels() const { return levels_; }
  double leaf_side() const { return leaf_side_; }
  double truncation() const { return truncation_; }

  /// The first brick of the box that is covered, and how many there are along each axis.
  const Cell& low() const { return low_; }
  const Cell& size() const { return size_; }

  /// Leaves along a side of a cell: 2, 4 or 8.
  int cell_leaves() const { return cell_leaves_; }
  int cells_a_brick() const { return Brick::side / cell_leaves_; }

  /// The centre of a leaf counted from the root's lowest corner, metres, on one axis.
  double centre(int leaf, std::size_t axis) const {
    return (leaf + 0.5) * leaf_side_ - (axis < 2 ? side_ / 2 : 0.0);
  }

  /// A brick counted from `low`, if it exists.
  const FieldBrick* find(const Cell& brick) const {
    const std::uint32_t index = names_[name_of(brick)];
    return index == 0 ? nullptr : &bricks_[index];
  }

  /// The same, made if it is missing. @throws OctreeFull
  FieldBrick& make(const Cell& brick);

  /// How many snapshots saw through a cell, counted from `low`.
  std::uint8_t& free_cell(const Cell& cell) { return free_[cell_of(cell)]; }
  std::uint8_t free_cell(const Cell& cell) const { return free_[cell_of(cell)]; }

  std::size_t bytes() const {
    return bricks_.bytes() + names_.capacity() * sizeof(names_[0]) + free_.capacity();
  }

 private:
  std::size_t name_of(const Cell& brick) const {
    return static_cast<std::size_t>((brick.z * size_.y + brick.y) * size_.x + brick.x);
  }
  std::size_t cell_of(const Cell& cell) const {
    const int a_brick = cells_a_brick();
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y * a_brick) +
            static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(size_.x * a_brick) +
           static_cast<std::size_t>(cell.x);
  }

  double side_;
  int levels_;
  double leaf_side_;
  double truncation_;
  std::size_t max_bytes_;
  int cell_leaves_;
  Cell low_ = {};
  Cell size_ = {};
  Pool<FieldBrick> bricks_ = {};
  std::vector<std::uint32_t> names_ = {};  // of bricks in the pool; 0 is none
  std::vector<std::uint8_t> free_ = {};
};

}  // namespace octurn
