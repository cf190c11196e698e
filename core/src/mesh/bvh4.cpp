#include "mesh/bvh4.hpp"

#include <algorithm>
#include <utility>

#include "parallel/radix_sort.hpp"

namespace octurn {
namespace {

constexpr int axis_bits = 10;

/// Moves bit i of ten to bit 3 i.
std::uint32_t spread_bits(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ffU;
  bits = (bits | bits << 8) & 0x0300f00fU;
  bits = (bits | bits << 4) & 0x030c30c3U;
  return (bits | bits << 2) & 0x09249249U;
}

/// Order of the boxes' centres along a Morton curve, which keeps neighbours together.
std::vector<std::uint32_t> morton_order(std::uint32_t count, const Bvh4::BoxAt& box_at) {
  Aabb all{.min = {Bvh4Node::far, Bvh4Node::far, Bvh4Node::far},
           .max = {-Bvh4Node::far, -Bvh4Node::far, -Bvh4Node::far}};
  for (std::uint32_t i = 0; i < count; ++i) {
    all.extend(box_at(i));
  }
  float side = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side = std::max(side, all.max[axis] - all.min[axis]);
  }
  const float scale = side > 0 ? ((1 << axis_bits) - 1) / side : 0.0F;
  std::vector<KeyIndex> keys;
  keys.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Aabb box = box_at(i);
    std::uint32_t key = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float centre = (box.min[axis] + box.max[axis]) / 2;
      key |= spread_bits(static_cast<std::uint32_t>((centre - all.min[axis]) * scale)) << axis;
    }
    keys.push_back({.key = key, .index = i});
  }
  radix_sort(keys, 3 * axis_bits);
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const KeyIndex& key : keys) {
    order.push_back(key.index);
  }
  return order;
}

}  // namespace

Bvh4::Bvh4(std::size_t count, const BoxAt& box)
    : order_(morton_order(static_cast<std::uint32_t>(count), box)) {
  levels_.emplace_back((order_.size() + 3) / 4);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    levels_[0][i / 4].set(i % 4, box(order_[i]));
  }
  while (levels_.back().size() > 1) {
    const std::vector<Bvh4Node>& below = levels_.back();
    std::vector<Bvh4Node> level((below.size() + 3) / 4);
    for (std::size_t i = 0; i < below.size(); ++i) {
      level[i / 4].set(i % 4, below[i].bounds());
    }
    levels_.push_back(std::move(level));
  }
}

}  // namespace octurn
