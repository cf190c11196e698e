#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "mesh/vector3.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Four boxes, tested at once; at first empty ones, which overlap none.
struct Bvh4Node {
  static constexpr float far = std::numeric_limits<float>::max();

  std::array<Eigen::Array4f, 3> min{Eigen::Array4f::Constant(far), Eigen::Array4f::Constant(far),
                                    Eigen::Array4f::Constant(far)};
  std::array<Eigen::Array4f, 3> max{-min[0], -min[1], -min[2]};

  void set(std::size_t i, const Aabb& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis][static_cast<Eigen::Index>(i)] = box.min[axis];
      max[axis][static_cast<Eigen::Index>(i)] = box.max[axis];
    }
  }

  Aabb bounds() const {
    return {.min = {min[0].minCoeff(), min[1].minCoeff(), min[2].minCoeff()},
            .max = {max[0].maxCoeff(), max[1].maxCoeff(), max[2].maxCoeff()}};
  }

  /// Gap to one box of another node, along the axis where it is widest; above 0 exactly where the
  /// boxes do not overlap.
  Eigen::Array4f separation(const Bvh4Node& other, std::size_t i) const {
    const auto along = [&](std::size_t axis) -> Eigen::Array4f {
      const auto lane = static_cast<Eigen::Index>(i);
      return (min[axis] - other.max[axis][lane]).max(other.min[axis][lane] - max[axis]);
    };
    return along(0).max(along(1)).max(along(2));
  }
};

/// Bounding volume hierarchy of four children per node, over boxes sorted along a Morton curve.
class Bvh4 {
 public:
  using BoxAt = std::function<Aabb(std::uint32_t)>;

  /// O(boxes). @param box  called several times for each: to store the boxes would take more memory
  ///                       than the hierarchy
  Bvh4(std::size_t count, const BoxAt& box, ThreadTeam& team = ThreadTeam::alone());

  /// Calls `visit(thread, i, j)` once for each pair of different boxes that overlap.
  template <typename Visit>
  void for_each_overlapping_pair(ThreadTeam& team, const Visit& visit) const {
    if (order_.empty()) {
      return;
    }
    const std::size_t top = levels_.size() - 1;
    const std::size_t split = split_level(team.size());
    NodePairs parts{{0, 0}};
    if (split < top) {
      parts.clear();
      traverse_pair(top, {0, 0}, split + 1, [&](const NodePair& pair) { parts.push_back(pair); });
    }
    std::atomic<std::size_t> next = 0;
    team.run([&](int thread) {
      for (std::size_t part = next++; part < parts.size(); part = next++) {
        traverse_pair(split, parts[part], 0, [&](const NodePair& pair) {
          if (pair[0] != pair[1]) {
            visit(thread, order_[pair[0]], order_[pair[1]]);
          }
        });
      }
    });
  }

 private:
  using NodePair = std::array<std::size_t, 2>;
  using NodePairs = std::vector<NodePair>;

  /// The highest level that has enough nodes for the threads.
  std::size_t split_level(int threads) const {
    std::size_t level = levels_.size() - 1;
    while (threads > 1 && level > 0 &&
           levels_[level].size() < nodes_per_thread * static_cast<std::size_t>(threads)) {
      --level;
    }
    return level;
  }

  /// Visits the overlapping pairs of children below two nodes of one level, or below one node, down
  /// to the level `end`.
  template <typename Visit>
  void traverse_pair(std::size_t level, const NodePair& nodes, std::size_t end,
                     const Visit& visit) const {
    const auto [a, b] = nodes;
    // Whether boxes overlap follows no pattern, so that a branch on it would be mispredicted.
    std::array<NodePair, 16> pairs;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Array4f gaps = levels_[level][b].separation(levels_[level][a], i);
      for (std::size_t j = 0; j < 4; ++j) {
        pairs[count] = {4 * a + i, 4 * b + j};
        count += gaps[static_cast<Eigen::Index>(j)] <= 0 && (a != b || i <= j) ? 1 : 0;
      }
    }
    for (const NodePair& pair : std::span(pairs).first(count)) {
      if (level > end) {
        traverse_pair(level - 1, pair, end, visit);
      } else {
        visit(pair);
      }
    }
  }

  static constexpr std::size_t nodes_per_thread = 16;

  std::vector<std::uint32_t> order_;                // of the boxes along the curve
  std::vector<std::vector<Bvh4Node>> levels_ = {};  // the lowest, of the boxes, first
};

}  // namespace octurn
