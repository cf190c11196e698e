#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "voxel/block_pool.hpp"

namespace octurn {

/// A sparse array of bricks: a dense table of indices into a BlockPool.
template <typename Item>
class BrickMap {
 public:
  explicit BrickMap(std::size_t size) : indices_(size) { bricks_.reserve(size); }

  /// The brick at a position of the table, or null.
  const Item* find(std::size_t at) const {
    return indices_[at] == 0 ? nullptr : &bricks_[indices_[at]];
  }
  Item* find(std::size_t at) { return indices_[at] == 0 ? nullptr : &bricks_[indices_[at]]; }

  /// Adds a brick at a position that has none.
  Item& add(std::size_t at) {
    indices_[at] = bricks_.add();
    return bricks_[indices_[at]];
  }

  void remove(std::size_t at) { bricks_.remove(std::exchange(indices_[at], 0)); }

  void clear() {
    bricks_ = {};
    bricks_.reserve(indices_.size());
    std::ranges::fill(indices_, 0U);
  }

  /// Whether the next `add` allocates `BlockPool<Item>::block_bytes`.
  bool is_full() const { return bricks_.is_full(); }

  /// Bytes of the bricks, without the table.
  std::size_t brick_bytes() const { return bricks_.bytes(); }

  std::size_t bytes() const {
    return bricks_.bytes() + indices_.capacity() * sizeof(std::uint32_t);
  }

 private:
  BlockPool<Item> bricks_ = {};
  std::vector<std::uint32_t> indices_;  // in the pool; 0 is none
};

}  // namespace octurn
