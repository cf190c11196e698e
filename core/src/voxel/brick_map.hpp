#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "voxel/block_pool.hpp"

namespace octurn {

/// The bricks of a field that exist, each at its place in a row of so many.
template <typename Item>
class BrickMap {
 public:
  explicit BrickMap(std::size_t places) : names_(places) {}

  /// The brick at a place, if it exists.
  const Item* find(std::size_t place) const {
    return names_[place] == 0 ? nullptr : &bricks_[names_[place]];
  }
  Item* find(std::size_t place) { return names_[place] == 0 ? nullptr : &bricks_[names_[place]]; }

  /// A new brick, at a place where there is none.
  Item& add(std::size_t place) {
    names_[place] = bricks_.add();
    return bricks_[names_[place]];
  }

  void remove(std::size_t place) { bricks_.remove(std::exchange(names_[place], 0)); }

  void clear() {
    bricks_ = {};
    std::ranges::fill(names_, 0U);
  }

  /// Whether the next `add` takes `BlockPool<Item>::block_bytes` more.
  bool is_full() const { return bricks_.is_full(); }

  std::size_t bytes() const { return bricks_.bytes() + names_.capacity() * sizeof(std::uint32_t); }

 private:
  BlockPool<Item> bricks_ = {};
  std::vector<std::uint32_t> names_;  // in the pool; 0 is none
};

}  // namespace octurn
