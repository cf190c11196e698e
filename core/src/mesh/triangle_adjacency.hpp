#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// The triangles of a mesh in chunks of consecutive ones. Each chunk stores the range of its vertex
/// indices, so that a thread that needs the triangles of a range of vertices skips most chunks:
/// triangles and vertices are in nearly the same order.
class TriangleChunks {
 public:
  /// O(triangles). A team of one thread has one chunk, whose range is not computed.
  TriangleChunks(std::span<const MeshTriangle> triangles, ThreadTeam& team)
      : triangles_(triangles),
        side_(team.size() > 1 ? some_triangles : std::max<std::size_t>(triangles.size(), 1)),
        ranges_((triangles.size() + side_ - 1) / side_) {
    if (team.size() == 1) {
      return;
    }
    team.run([&](int thread) {
      const auto [first, end] = team.share(ranges_.size(), thread);
      for (std::size_t chunk = first; chunk < end; ++chunk) {
        ranges_[chunk] = find_range(
            triangles_.subspan(chunk * side_, std::min(side_, triangles_.size() - chunk * side_)));
      }
    });
  }

  /// A lower bound of all vertex indices.
  std::uint32_t low() const {
    std::uint32_t low = std::numeric_limits<std::uint32_t>::max();
    for (const Range& range : ranges_) {
      low = std::min(low, range.min);
    }
    return low;
  }

  /// Calls `visit(index, triangle)` in ascending order for all triangles with a vertex from `first`
  /// to below `end`, and for some others.
  template <typename Visit>
  void for_each(std::size_t first, std::size_t end, const Visit& visit) const {
    for (std::size_t chunk = 0; chunk < ranges_.size(); ++chunk) {
      if (ranges_[chunk].meets(first, end)) {
        const std::size_t behind = std::min((chunk + 1) * side_, triangles_.size());
        for (std::size_t i = chunk * side_; i < behind; ++i) {
          visit(i, triangles_[i]);
        }
      }
    }
  }

  /// The same in descending order.
  template <typename Visit>
  void for_each_backwards(std::size_t first, std::size_t end, const Visit& visit) const {
    for (std::size_t chunk = ranges_.size(); chunk-- > 0;) {
      if (ranges_[chunk].meets(first, end)) {
        for (std::size_t i = std::min((chunk + 1) * side_, triangles_.size());
             i-- > chunk * side_;) {
          visit(i, triangles_[i]);
        }
      }
    }
  }

 private:
  static constexpr std::size_t some_triangles = 256;

  /// A range of vertex indices, both ends included; by default that of all indices.
  struct Range {
    std::uint32_t min = 0;
    std::uint32_t max = std::numeric_limits<std::uint32_t>::max();

    bool meets(std::size_t first, std::size_t end) const { return min < end && max >= first; }
  };

  static Range find_range(std::span<const MeshTriangle> triangles) {
    Range range{.min = std::numeric_limits<std::uint32_t>::max(), .max = 0};
    for (const MeshTriangle& triangle : triangles) {
      for (const std::uint32_t corner : triangle) {
        range.min = std::min(range.min, corner);
        range.max = std::max(range.max, corner);
      }
    }
    return range;
  }

  std::span<const MeshTriangle> triangles_;
  std::size_t side_;
  std::vector<Range> ranges_;
};

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
