#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "bennett/voxelize_triangle.hpp"
#include "core/bennett/plain_octree.hpp"

namespace octurn {

// Converts the results of the fast implementation into the form of the plain one.

using Leaves = std::set<std::array<int, 3>>;

inline Leaves leaves_of(const Octree& octree) {
  Leaves leaves;
  octree.for_each_brick([&](const Index3& cell, const Brick& brick) {
    for (int z = 0; z < Brick::side; ++z) {
      for (int bit = 0; bit < 64; ++bit) {
        if (brick.layers[static_cast<std::size_t>(z)] >> bit & 1) {
          leaves.insert({cell.x * Brick::side + bit % Brick::side,
                         cell.y * Brick::side + bit / Brick::side, cell.z * Brick::side + z});
        }
      }
    }
  });
  return leaves;
}

/// The most leaves that a triangle can span along an axis.
inline int leaves_across(const std::array<SnapPoint, 3>& corners, int levels) {
  int span = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    span = std::max(span, (high - low) >> (SnapGrid::bits - levels));
  }
  return span;
}

inline std::vector<Facet> surface_of(const Octree& octree) {
  std::vector<Facet> facets;
  marching_tetrahedra(octree, all_layers(octree), 1, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return facets;
}

/// Converts facets into the plain implementation's triangles: corners in half leaves, sorted.
inline std::vector<plain::Triangle> in_half_leaves(const Octree& octree,
                                                   const std::vector<Facet>& facets) {
  std::vector<plain::Triangle> triangles;
  const double half_leaf_mm = octree.leaf_side() * 500;
  const double corner_mm = octree.side() * 500;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    plain::Triangle triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double mm = static_cast<double>(corners[i][axis]) + (axis < 2 ? corner_mm : 0.0);
        triangle[i][axis] = static_cast<int>(std::lround(mm / half_leaf_mm));
      }
    }
    std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
    triangles.push_back(triangle);
  }
  std::ranges::sort(triangles);
  return triangles;
}

}  // namespace octurn
