#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mesh/aabb.hpp"

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
  /// O(boxes).
  explicit Bvh4(std::span<const Aabb> boxes);

  /// Calls `visit(i, j)` once for each pair of different boxes that overlap.
  template <typename Visit>
  void for_each_overlapping_pair(const Visit& visit) const {
    if (!order_.empty()) {
      traverse_pair(levels_.size() - 1, 0, 0, visit);
    }
  }

 private:
  /// Visits the pairs below two nodes of one level, or below one with itself.
  template <typename Visit>
  void traverse_pair(std::size_t level, std::size_t a, std::size_t b, const Visit& visit) const {
    // Whether boxes overlap follows no pattern, so that a branch on it would be mispredicted.
    std::array<std::array<std::size_t, 2>, 16> pairs;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Array4f gaps = levels_[level][b].separation(levels_[level][a], i);
      for (std::size_t j = 0; j < 4; ++j) {
        pairs[count] = {4 * a + i, 4 * b + j};
        count += gaps[static_cast<Eigen::Index>(j)] <= 0 && (a != b || i <= j) ? 1 : 0;
      }
    }
    for (const auto& [one, other] : std::span(pairs).first(count)) {
      if (level > 0) {
        traverse_pair(level - 1, one, other, visit);
      } else if (one != other) {
        visit(order_[one], order_[other]);
      }
    }
  }

  std::vector<std::uint32_t> order_;                // of the boxes along the curve
  std::vector<std::vector<Bvh4Node>> levels_ = {};  // the lowest, of the boxes, first
};

}  // namespace octurn
