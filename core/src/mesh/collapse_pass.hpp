#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/indexed_mesh.hpp"
#include "mesh/mesh.hpp"
#include "mesh/qem_simplify.hpp"
#include "mesh/triangle_adjacency.hpp"
#include "mesh/vector3.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// A candidate edge collapse. The new vertex's position is not stored, as the list is long: it is
/// computed again from the quadrics of both ends when the edge is collapsed.
struct Collapse {
  double cost = 0;  ///< mean square distance, mm^2
  std::uint32_t kept = 0;
  std::uint32_t removed = 0;
};

/// Sorts by cost and removes duplicates. Equal costs are sorted by vertex index, so that the result
/// does not depend on the order before.
void sort_by_cost(std::vector<Collapse>& collapses);

/// For each vertex the index of its strip.
using VertexStrips = std::vector<std::uint16_t>;

/// Divides vertices into strips across an axis, about as many vertices in each.
/// @param axis   0 to 2
/// @param count  of strips, at least 1
VertexStrips make_strips(std::span<const MeshVertex> vertices, std::size_t axis, int count,
                         ThreadTeam& team = ThreadTeam::alone());

/// One pass of edge collapse over all edges up to a maximum cost, the cheapest first. Changes the
/// mesh that it refers to.
///
/// Several threads make the same collapses as one thread would. The order of two collapses matters
/// only if an end of one is an end of the other, or a neighbour of it. Each thread collapses the
/// edges within its own strip of vertices, in order. It defers an edge with a neighbour in another
/// strip, or beside a deferred edge. The deferred edges, few and along the borders, are done next
/// with strips across another axis, and those deferred again by one thread. Each collapse
/// therefore finds its neighbourhood as in the sequential order (the conflicts of Blelloch,
/// Fineman, Gibbons and Shun 2012, here by location).
class CollapsePass {
 public:
  /// @param dirty  one per vertex: not 0 if a triangle around it changed since the last pass
  CollapsePass(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
               std::vector<char> dirty, ThreadTeam& team)
      : mesh_(mesh),
        locked_(locked),
        limits_(limits),
        team_(team),
        was_dirty_(std::move(dirty)),
        adjacency_(mesh.triangles, mesh.vertices.size(), team, locked),
        is_dirty_(mesh.vertices.size(), 0),
        is_stale_(mesh.vertices.size(), 0) {}

  /// @param already_tried  cost up to which the last pass tried every edge: where no triangle
  ///                       changed since, these would be refused again
  /// @param tilings        divisions into at most as many strips as the team has threads; none for
  ///                       one
  /// @returns how many edges were collapsed
  std::size_t run(double max_cost, double already_tried, std::span<const VertexStrips> tilings);

  std::vector<char> take_dirty() { return std::move(is_dirty_); }

 private:
  using Collapses = std::vector<Collapse>;
  using Position = std::array<float, 3>;

  Collapses list_collapses(std::span<const MeshTriangle> triangles, double max_cost,
                           double already_tried) const;
  Position optimum(std::uint32_t a, std::uint32_t b, const Quadric& sum) const;
  std::size_t collapse_in_strips(const VertexStrips& strips, std::vector<Collapses>& lists);
  std::size_t collapse_all(const Collapses& collapses);
  void prefetch(const Collapse& collapse) const;
  bool make_if_valid(const Collapse& collapse);
  bool meets_link_condition(std::uint32_t a, std::uint32_t b) const;
  bool are_neighbours(std::uint32_t a, std::uint32_t b) const;
  bool flips_or_degenerates(const Position& to, std::uint32_t centre,
                            std::uint32_t other_end) const;
  void apply(const Collapse& collapse, const Position& position, const Quadric& sum);

  Vector3 position(std::uint32_t vertex) const {
    return to_vector3(mesh_.vertices[vertex].position);
  }

  class Strip;

  IndexedMesh& mesh_;
  std::span<const char> locked_;
  CollapseLimits limits_;
  ThreadTeam& team_;
  std::vector<char> was_dirty_;
  TriangleAdjacency adjacency_;  // as the pass began, of vertices that are not locked
  std::vector<char> is_dirty_;
  std::vector<char> is_stale_;  // vertices whose adjacency a collapse has outdated
};

}  // namespace octurn
