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

constexpr Aabb no_box{.min = {Bvh4Node::far, Bvh4Node::far, Bvh4Node::far},
                      .max = {-Bvh4Node::far, -Bvh4Node::far, -Bvh4Node::far}};

Aabb bounds_of_all(std::size_t count, const Bvh4::BoxAt& box_at, ThreadTeam& team) {
  std::vector<Aabb> shares(static_cast<std::size_t>(team.size()), no_box);
  team.run([&](int thread) {
    Aabb all = no_box;
    const auto [first, end] = team.share(count, thread);
    for (std::size_t i = first; i < end; ++i) {
      all.extend(box_at(static_cast<std::uint32_t>(i)));
    }
    shares[static_cast<std::size_t>(thread)] = all;
  });
  Aabb all = no_box;
  for (const Aabb& share : shares) {
    all.extend(share);
  }
  return all;
}

/// Order of the boxes' centres along a Morton curve, which keeps neighbours together.
std::vector<KeyIndex> morton_order(std::size_t count, const Bvh4::BoxAt& box_at, ThreadTeam& team) {
  const Aabb all = bounds_of_all(count, box_at, team);
  float side = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side = std::max(side, all.max[axis] - all.min[axis]);
  }
  const float scale = side > 0 ? ((1 << axis_bits) - 1) / side : 0.0F;
  std::vector<KeyIndex> keys(count);
  team.run([&](int thread) {
    const auto [first, end] = team.share(count, thread);
    for (std::size_t i = first; i < end; ++i) {
      const auto index = static_cast<std::uint32_t>(i);
      const Aabb box = box_at(index);
      std::uint32_t key = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float centre = (box.min[axis] + box.max[axis]) / 2;
        key |= spread_bits(static_cast<std::uint32_t>((centre - all.min[axis]) * scale)) << axis;
      }
      keys[i] = {.key = key, .index = index};
    }
  });
  radix_sort(keys, 3 * axis_bits);
  return keys;
}

}  // namespace

Bvh4::Bvh4(std::size_t count, const BoxAt& box, ThreadTeam& team) : order_(count) {
  const std::vector<KeyIndex> keys = morton_order(count, box, team);
  levels_.emplace_back((count + 3) / 4);
  std::vector<Bvh4Node>& lowest = levels_.front();
  team.run([&](int thread) {
    const auto [first, end] = team.share(lowest.size(), thread);
    for (std::size_t i = 4 * first; i < std::min(4 * end, count); ++i) {
      order_[i] = keys[i].index;
      lowest[i / 4].set(i % 4, box(order_[i]));
    }
  });
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
