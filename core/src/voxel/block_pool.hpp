#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace octurn {

/// A pool of items in blocks that never move. Blocks are added one at a time, so that memory does
/// not double as a vector's does. An item has an index; index 0 is reserved and means "none".
template <typename Item>
class BlockPool {
 public:
  static constexpr std::uint32_t block_items = 512;
  static constexpr std::size_t block_bytes = block_items * sizeof(Item);

  BlockPool() { add(); }

  /// Reserves the table for so many items, so that no `add` moves it: then one thread may add items
  /// while others use items whose index they have.
  void reserve(std::size_t items) { blocks_.reserve(items / block_items + 2); }

  /// The index of a new item, equal to `Item{}`.
  std::uint32_t add() {
    if (!free_.empty()) {
      const std::uint32_t index = free_.back();
      free_.pop_back();
      (*this)[index] = Item{};
      return index;
    }
    if (used_ == blocks_.size() * block_items) {
      blocks_.push_back(std::make_unique<std::array<Item, block_items>>());
    }
    return used_++;
  }

  /// Frees an item; `add` reuses its index.
  void remove(std::uint32_t index) { free_.push_back(index); }

  /// Whether the next `add` allocates a block.
  bool is_full() const { return free_.empty() && used_ == blocks_.size() * block_items; }

  Item& operator[](std::uint32_t i) { return (*blocks_[i / block_items])[i % block_items]; }
  const Item& operator[](std::uint32_t i) const {
    return (*blocks_[i / block_items])[i % block_items];
  }

  /// Bytes allocated, including those of removed items.
  std::size_t bytes() const {
    return blocks_.size() * block_bytes + free_.capacity() * sizeof(std::uint32_t);
  }

 private:
  std::vector<std::unique_ptr<std::array<Item, block_items>>> blocks_ = {};
  std::vector<std::uint32_t> free_ = {};
  std::uint32_t used_ = 0;
};

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
