#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/triangle_adjacency.hpp"
#include "mesh/vertex_strips.hpp"

namespace octurn {

/// Where the neighbours of a vertex lie.
enum class Reach : char {
  unknown,  ///< not determined yet
  within,   ///< all in its own strip, and none beside a deferred collapse
  beyond,
};

/// The vertices of a strip that its thread may collapse while other threads work on theirs.
class StripReach {
 public:
  /// @param triangles  as the collapses change them
  /// @param adjacency  of the vertices that were not collapsed since
  /// @param reach      one per vertex, at first `unknown`; changed in this strip only
  StripReach(std::span<const MeshTriangle> triangles, const TriangleAdjacency& adjacency,
             const VertexStrips& strips, int strip, std::span<Reach> reach)
      : triangles_(triangles),
        adjacency_(adjacency),
        strips_(strips),
        strip_(strip),
        reach_(reach) {}

  bool has(std::uint32_t vertex) const { return strips_[vertex] == strip_; }

  /// A collapse within the strip never joins a vertex to one beyond it: `within` stays true until a
  /// collapse beside the vertex is deferred.
  bool is_within(std::uint32_t vertex) {
    if (!has(vertex)) {
      return false;
    }
    if (reach_[vertex] == Reach::unknown) {
      const bool is_within =
          std::ranges::all_of(adjacency_.triangles_at(vertex), [&](std::uint32_t i) {
            return std::ranges::all_of(triangles_[i],
                                       [&](std::uint32_t corner) { return has(corner); });
          });
      reach_[vertex] = is_within ? Reach::within : Reach::beyond;
    }
    return reach_[vertex] == Reach::within;
  }

  /// A collapse at this vertex was deferred: later ones that depend on it must be, too.
  void leave_around(std::uint32_t vertex) {
    if (!has(vertex)) {
      return;
    }
    for (const std::uint32_t i : adjacency_.triangles_at(vertex)) {
      for (const std::uint32_t corner : triangles_[i]) {
        if (has(corner)) {
          reach_[corner] = Reach::beyond;
        }
      }
    }
  }

 private:
  std::span<const MeshTriangle> triangles_;
  const TriangleAdjacency& adjacency_;
  const VertexStrips& strips_;
  int strip_;
  std::span<Reach> reach_;
};

}  // namespace octurn
