#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace octurn {

/// Which corner of a triangle a vertex is, of one that it has.
inline std::size_t local_index(const MeshTriangle& triangle, std::uint32_t vertex) {
  return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}

/// The triangles at each vertex of a mesh.
class TriangleAdjacency {
 public:
  void assign(std::span<const MeshTriangle> triangles, std::size_t vertices) {
    first_.assign(vertices + 1, 0);
    for (const MeshTriangle& triangle : triangles) {
      for (const std::uint32_t corner : triangle) {
        ++first_[corner];
      }
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(3 * triangles.size());
    for (std::size_t i = triangles.size(); i-- > 0;) {
      for (const std::uint32_t corner : triangles[i]) {
        triangles_[--first_[corner]] = static_cast<std::uint32_t>(i);
      }
    }
  }

  /// In the order of the mesh.
  std::span<const std::uint32_t> triangles_of(std::uint32_t vertex) const {
    return std::span(triangles_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> first_ = {};
  std::vector<std::uint32_t> triangles_ = {};
};

}  // namespace octurn
