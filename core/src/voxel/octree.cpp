#include "voxel/octree.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace octurn {

int Octree::level_for(double side, double leaf_size) {
  int level = 0;
  while (level < max_levels && side / (1 << level) > leaf_size) {
    ++level;
  }
  return level;
}

Octree::Octree(double side, int levels, std::size_t max_bytes)
    : side_(side),
      levels_(levels),
      height_(std::max(levels - Brick::levels, 0)),
      max_bytes_(max_bytes) {
  if (!(side > 0) || levels < 0 || levels > max_levels) {
    throw std::invalid_argument("Octree: side or levels out of range");
  }
  root_ = height_ > 0 ? nodes_.add() : bricks_.add();
}

double Octree::leaf_side() const { return side_ / (1 << levels_); }

std::uint64_t Octree::leaf_count(int low, int end) const {
  std::uint64_t count = 0;
  for (int layer = low; layer < end; ++layer) {
    for_each_brick(layer, [&](const Index3&, const Brick& brick) {
      for (const std::uint64_t leaves : brick.layers) {
        count += static_cast<std::uint64_t>(std::popcount(leaves));
      }
    });
  }
  return count;
}

std::size_t Octree::brick_count(int layer) const {
  std::size_t count = 0;
  for_each_brick(layer, [&](const Index3&, const Brick&) { ++count; });
  return count;
}

Brick& Octree::brick_at(const Index3& brick) {
  std::uint32_t index = root_;
  for (int height = height_; height > 0; --height) {
    std::uint32_t& child = nodes_[index][child_index(brick, height)];
    if (child == 0) {
      child = add_child(height);
    }
    index = child;
  }
  return bricks_[index];
}

std::uint32_t Octree::add_child(int height) {
  const bool is_brick = height == 1;
  const std::size_t block = is_brick ? bricks_.block_bytes : nodes_.block_bytes;
  if ((is_brick ? bricks_.is_full() : nodes_.is_full()) && bytes() + block > max_bytes_) {
    throw OutOfBudget();
  }
  return is_brick ? bricks_.add() : nodes_.add();
}

void Octree::remove_layers_from(int layer) {
  recent_ = {};
  if (height_ == 0) {
    if (layer <= 0) {
      bricks_[root_] = {};
    }
    return;
  }
  remove(root_, height_, 0, layer);
}

/// @param low  the lowest brick layer of the node `index`
void Octree::remove(std::uint32_t index, int height, int low, int layer) {
  const int half = 1 << (height - 1);
  for (std::size_t child = 0; child < 8; ++child) {
    std::uint32_t& below = nodes_[index][child];
    const int child_low = low + (child & 4 ? half : 0);
    if (below == 0 || child_low + half <= layer) {
      continue;
    }
    if (height > 1) {
      remove(below, height - 1, child_low, layer);
    }
    if (child_low >= layer) {
      if (height > 1) {
        nodes_.remove(below);
      } else {
        bricks_.remove(below);
      }
      below = 0;
    }
  }
}

const Brick* Octree::find(const Index3& brick) const {
  if ((brick.x | brick.y | brick.z) >> height_ != 0) {
    return nullptr;  // outside the root; a negative coordinate keeps its sign bit
  }
  std::uint32_t index = root_;
  for (int height = height_; height > 0; --height) {
    index = nodes_[index][child_index(brick, height)];
    if (index == 0) {
      return nullptr;
    }
  }
  return &bricks_[index];
}

void Octree::merge(const Octree& other) {
  if (other.side_ != side_ || other.levels_ != levels_) {
    throw std::invalid_argument("Octree::merge: octrees of different shape");
  }
  merge(root_, other, other.root_, height_);
}

/// Merges the subtree of another octree's node into the node at the same place.
void Octree::merge(std::uint32_t to, const Octree& other, std::uint32_t from, int height) {
  if (height == 0) {
    for (std::size_t z = 0; z < Brick::side; ++z) {
      bricks_[to].layers[z] |= other.bricks_[from].layers[z];
    }
    return;
  }
  for (std::size_t child = 0; child < 8; ++child) {
    if (const std::uint32_t below = other.nodes_[from][child]; below != 0) {
      std::uint32_t& here = nodes_[to][child];
      if (here == 0) {
        here = add_child(height);
      }
      merge(here, other, below, height - 1);
    }
  }
}

Octree Octree::at_level(int level) const {
  if (level < 0 || level > levels_) {
    throw std::invalid_argument("Octree::at_level: no such level");
  }
  const int finer = levels_ - level;
  Octree coarse(side_, level);
  for_each_brick([&](const Index3& cell, const Brick& brick) {
    for (int z = 0; z < Brick::side; ++z) {
      for (std::uint64_t rest = brick.layers[static_cast<std::size_t>(z)]; rest != 0;
           rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        coarse.set({(cell.x * Brick::side + bit % Brick::side) >> finer,
                    (cell.y * Brick::side + bit / Brick::side) >> finer,
                    (cell.z * Brick::side + z) >> finer});
      }
    }
  });
  return coarse;
}

}  // namespace octurn
