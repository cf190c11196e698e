#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "octurn/reconstruct.hpp"
#include "voxel/block_pool.hpp"
#include "voxel/index3.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {

/// 8 x 8 x 8 leaves, a bit for each: the three lowest levels of the octree in one cache line.
/// Leaf (x, y, z) of the brick is bit x + 8 y of layers[z].
struct alignas(64) Brick {
  static constexpr int side = 8;  // leaves
  static constexpr int levels = 3;
  std::array<std::uint64_t, side> layers = {};
};

/// A sparse voxel octree of occupancy: a root cube, halved along each axis `levels` times, of which
/// only the nodes with an occupied leaf exist. A node of any level is the union of its leaves, so
/// only leaves are stored: a bit for each, in bricks, below a tree of eight children a node.
///
/// The root stands on the platform: x and y from -side/2 to side/2, z from 0 to side, metres.
class Octree {
 public:
  static constexpr int max_levels = octurn::max_levels;

  /// The first level whose nodes are at or below `leaf_size`, both in metres.
  static int level_for(double side, double leaf_size);

  /// @param max_bytes  that its nodes and bricks may take
  /// @throws std::invalid_argument  unless side > 0 and 0 <= levels <= max_levels
  Octree(double side, int levels, std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

  double side() const { return side_; }  ///< of the root, metres
  int levels() const { return levels_; }
  double leaf_side() const;  ///< metres
  int leaves_per_side() const { return 1 << levels_; }
  int brick_layers() const { return 1 << height_; }
  std::size_t bytes() const { return nodes_.bytes() + bricks_.bytes(); }
  std::uint64_t leaf_count() const { return leaf_count(0, brick_layers()); }

  /// Occupied leaves in the layers of bricks from `low` up to but without `end`.
  std::uint64_t leaf_count(int low, int end) const;

  /// Bricks in one layer.
  std::size_t brick_count(int layer) const;

  /// Occupies a leaf, which must lie in the root. @throws OutOfBudget
  void set(const Index3& leaf) {
    const auto x = static_cast<unsigned>(leaf.x);
    const auto y = static_cast<unsigned>(leaf.y);
    const auto z = static_cast<unsigned>(leaf.z);
    brick_near(x / Brick::side, y / Brick::side, z / Brick::side).layers[z % Brick::side] |=
        std::uint64_t{1} << (x % Brick::side + y % Brick::side * Brick::side);
  }

  /// The brick at that position, if it exists. The position may lie outside the root.
  const Brick* find(const Index3& brick) const;

  /// Calls `visit(Index3 brick, const Brick&)` for the bricks of one layer, x before y in Morton
  /// order; the order depends on the bricks alone.
  template <typename Visit>
  void for_each_brick(int layer, Visit visit) const {
    if (layer >= 0 && layer >> height_ == 0) {
      visit_layer(root_, height_, {0, 0, layer}, visit);
    }
  }

  /// Calls `visit(Index3 brick, const Brick&)` for every brick, layer by layer, as above.
  template <typename Visit>
  void for_each_brick(Visit visit) const {
    for (int layer = 0; layer < brick_layers(); ++layer) {
      for_each_brick(layer, visit);
    }
  }

  /// Adds the leaves of another octree of the same side and levels. @throws OutOfBudget
  void merge(const Octree& other);

  /// Removes the bricks of this layer and all above it. Their memory is kept for new ones.
  void remove_layers_from(int layer);

  void clear() { remove_layers_from(0); }

  /// The octree cut off at a coarser level: its leaves are this one's nodes of that level.
  /// @throws std::invalid_argument  unless 0 <= level <= levels()
  Octree at_level(int level) const;

 private:
  using Node = std::array<std::uint32_t, 8>;  // children: nodes, or bricks at height 1; 0 is none

  static std::size_t child_index(const Index3& brick, int height) {
    const int bit = height - 1;
    return static_cast<std::size_t>((brick.x >> bit & 1) | (brick.y >> bit & 1) << 1 |
                                    (brick.z >> bit & 1) << 2);
  }

  Brick& brick_at(const Index3& brick);
  std::uint32_t add_child(int height);
  void merge(std::uint32_t to, const Octree& other, std::uint32_t from, int height);
  void remove(std::uint32_t index, int height, int low, int layer);

  /// The brick at that position, made if missing. Neighbouring samples fall into neighbouring
  /// bricks, so a cache of those set last saves most descents.
  Brick& brick_near(unsigned x, unsigned y, unsigned z) {
    Recent& recent = recent_[x % 4 + y % 4 * 4 + z % 4 * 16];
    const std::uint64_t key = x | std::uint64_t{y} << 20U | std::uint64_t{z} << 40U;
    if (recent.brick == nullptr || recent.key != key) {
      recent = {
          .key = key,
          .brick = &brick_at({static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)})};
    }
    return *recent.brick;
  }

  template <typename Visit>
  void visit_layer(std::uint32_t index, int height, const Index3& low, Visit& visit) const {
    if (height == 0) {
      visit(low, bricks_[index]);
      return;
    }
    const int half = 1 << (height - 1);
    const std::size_t upper = low.z >> (height - 1) & 1 ? 4 : 0;
    for (std::size_t child = 0; child < 4; ++child) {
      if (const std::uint32_t below = nodes_[index][upper + child]; below != 0) {
        visit_layer(below, height - 1,
                    {low.x + (child & 1 ? half : 0), low.y + (child & 2 ? half : 0), low.z}, visit);
      }
    }
  }

  struct Recent {
    std::uint64_t key = 0;  // the brick's coordinates, 20 bits each
    Brick* brick = nullptr;
  };

  double side_;
  int levels_;
  int height_;  // of the root above the bricks
  std::size_t max_bytes_;
  BlockPool<Node> nodes_ = {};
  BlockPool<Brick> bricks_ = {};
  std::uint32_t root_ = 0;
  std::array<Recent, 64> recent_ = {};
};

}  // namespace octurn
