#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/triangle_chunks.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Local index (0, 1, 2) of `vertex` in `triangle`, which must contain it.
inline std::size_t local_index(const MeshTriangle& triangle, std::uint32_t vertex) {
  return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}

/// Triangles at each vertex of a mesh, as compressed rows (CSR).
class TriangleAdjacency {
 public:
  /// O(vertices + triangles); each thread reads the chunks of triangles that reach its vertices.
  /// @param left_out  one per vertex: not 0 if its triangles are not needed; empty: all are needed
  TriangleAdjacency(std::span<const MeshTriangle> triangles, std::size_t vertex_count,
                    ThreadTeam& team = ThreadTeam::alone(), std::span<const char> left_out = {})
      : first_(vertex_count + 1, 0) {
    const auto is_left_out = [&](std::uint32_t vertex) {
      return !left_out.empty() && left_out[vertex] != 0;
    };
    const TriangleChunks chunks(triangles, team);
    team.run([&](int thread) {
      const auto [first, end] = team.share(vertex_count, thread);
      chunks.for_each(
          first, end,
          [&, low = first, count = end - first](std::size_t, const MeshTriangle& triangle) {
            for (const std::uint32_t corner : triangle) {
              if (corner - low < count && !is_left_out(corner)) {
                ++first_[corner];
              }
            }
          });
    });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(first_.back());
    team.run([&](int thread) {
      const auto [first, end] = team.share(vertex_count, thread);
      chunks.for_each_backwards(
          first, end,
          [&, low = first, count = end - first](std::size_t i, const MeshTriangle& triangle) {
            for (const std::uint32_t corner : triangle) {
              if (corner - low < count && !is_left_out(corner)) {
                triangles_[--first_[corner]] = static_cast<std::uint32_t>(i);
              }
            }
          });
    });
  }

  /// Indices of the triangles at a vertex, ascending.
  std::span<const std::uint32_t> triangles_at(std::uint32_t vertex) const {
    return std::span(triangles_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> triangles_ = {};
};

}  // namespace octurn
