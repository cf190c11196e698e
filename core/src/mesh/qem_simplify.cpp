#include "mesh/qem_simplify.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

#include "mesh/triangle_adjacency.hpp"
#include "mesh/vector3.hpp"
#include "octurn/snapshot.hpp"
#include "parallel/radix_sort.hpp"

namespace octurn {
namespace {

constexpr int passes = 6;
constexpr double full_error_pass = 0.6 * passes;  // from this on the limit is the target
constexpr std::size_t prefetch_distance = 6;      // collapses
constexpr double min_edge_mm = 0.036;             // slicers weld vertices that are closer
constexpr double min_normal_cosine = 0.5;         // between a triangle's normals before and after
constexpr double max_aspect = 20;                 // longest side to smallest height

/// Whether one of a triangle's edges was collapsed.
bool is_degenerate(const MeshTriangle& triangle) {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

struct Collapse {
  double cost = 0;  // mean square distance, mm^2
  std::uint32_t kept = 0;
  std::uint32_t removed = 0;
  std::array<float, 3> position = {};  // of the vertex that is kept
};

/// The cheapest first: by the upper half of the bits of their costs, which order as the costs do,
/// as these are not negative; then the few that have those bits in common by the whole key.
void sort_by_cost(std::vector<Collapse>& collapses) {
  std::vector<KeyIndex> keys;
  keys.reserve(collapses.size());
  for (const Collapse& collapse : collapses) {
    keys.push_back(
        {.key = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(collapse.cost) >> 32),
         .index = static_cast<std::uint32_t>(keys.size())});
  }
  radix_sort(keys, 32);
  const auto whole_key = [&](const KeyIndex& key) {
    const Collapse& collapse = collapses[key.index];
    return std::tuple(collapse.cost, collapse.kept, collapse.removed);
  };
  for (auto first = keys.begin(); first != keys.end();) {
    const auto end =
        std::find_if(first, keys.end(), [&](const KeyIndex& key) { return key.key != first->key; });
    std::ranges::sort(first, end, {}, whole_key);
    first = end;
  }
  std::vector<Collapse> sorted;
  sorted.reserve(keys.size());
  for (const KeyIndex& key : keys) {
    sorted.push_back(collapses[key.index]);
  }
  collapses.swap(sorted);
}

/// One pass over all edges up to one cost. Refers to the mesh and changes it.
class CollapsePass {
 public:
  /// @param dirty  one per vertex: not 0 where a triangle around has changed since the last pass
  CollapsePass(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
               std::vector<char> dirty)
      : mesh_(mesh),
        locked_(locked),
        limits_(limits),
        was_dirty_(std::move(dirty)),
        adjacency_(mesh.triangles, mesh.vertices.size()),
        is_dirty_(mesh.vertices.size(), 0),
        is_stale_(mesh.vertices.size(), 0) {}

  /// @param already_tried  cost up to which the last pass tried every edge: where nothing has
  ///                       changed since, it would be refused again
  /// @returns how many edges were collapsed
  std::size_t run(double max_cost, double already_tried) {
    const std::vector<Collapse> collapses = list_collapses(max_cost, already_tried);
    std::size_t done = 0;
    for (std::size_t i = 0; i < collapses.size(); ++i) {
      const Collapse& collapse = collapses[i];
      prefetch(collapses[std::min(i + prefetch_distance, collapses.size() - 1)]);
      if (is_stale_[collapse.kept] == 0 && is_stale_[collapse.removed] == 0 && is_valid(collapse)) {
        apply(collapse);
        ++done;
      }
    }
    std::erase_if(mesh_.triangles, is_degenerate);
    return done;
  }

  std::vector<char> take_dirty() { return std::move(is_dirty_); }

 private:
  std::vector<Collapse> list_collapses(double max_cost, double already_tried) const {
    std::vector<Collapse> collapses;
    for (const MeshTriangle& triangle : mesh_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = triangle[i];
        const std::uint32_t b = triangle[(i + 1) % 3];
        // A closed mesh has each edge once in either direction.
        if (a < b && locked_[a] == 0 && locked_[b] == 0) {
          const bool is_known = was_dirty_[a] == 0 && was_dirty_[b] == 0;
          if (is_known && max_cost <= already_tried) {
            continue;
          }
          const Collapse collapse = make_collapse(a, b);
          if (collapse.cost <= max_cost && !(is_known && collapse.cost <= already_tried)) {
            collapses.push_back(collapse);
          }
        }
      }
    }
    sort_by_cost(collapses);
    return collapses;
  }

  Collapse make_collapse(std::uint32_t a, std::uint32_t b) const {
    Quadric sum = mesh_.quadrics[a];
    sum += mesh_.quadrics[b];
    const Vector3 from = position(a);
    const Vector3 to = position(b);
    const Vector3 middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (from[2] + to[2]) / 2};
    const bool is_on_platform = from[2] == 0 || to[2] == 0;
    const Vector3 best = is_on_platform ? sum.optimum_on_platform(middle) : sum.optimum(middle);
    Collapse collapse{.cost = 0,
                      .kept = a,
                      .removed = b,
                      .position = {static_cast<float>(best[0]), static_cast<float>(best[1]),
                                   static_cast<float>(best[2])}};
    collapse.cost = sum.mean_square(to_vector3(collapse.position));
    return collapse;
  }

  /// Collapses are spread over the mesh by their order, and the mesh does not fit in the cache.
  void prefetch(const Collapse& collapse) const {
    for (const std::uint32_t end : {collapse.kept, collapse.removed}) {
      __builtin_prefetch(&mesh_.vertices[end]);
      __builtin_prefetch(&mesh_.quadrics[end]);
      __builtin_prefetch(&mesh_.triangles[adjacency_.triangles_at(end).front()]);
      __builtin_prefetch(&mesh_.triangles[adjacency_.triangles_at(end).back()]);
    }
  }

  bool is_valid(const Collapse& collapse) const {
    const auto& [cost, a, b, position] = collapse;
    if (position[2] < limits_.min_z || position[2] > limits_.max_z) {
      return false;
    }
    // In this order, as flips refuse half of all collapses and the link condition next to none.
    return !flips_or_degenerates(collapse, a, b) && !flips_or_degenerates(collapse, b, a) &&
           meets_link_condition(a, b);
  }

  /// Whether the ends have just the two neighbours in common that face the edge, and the vertex
  /// that is kept will have three triangles or more.
  bool meets_link_condition(std::uint32_t a, std::uint32_t b) const {
    int common = 0;
    std::size_t triangles = 0;
    for (const std::uint32_t i : adjacency_.triangles_at(a)) {
      const MeshTriangle& triangle = mesh_.triangles[i];
      if (is_degenerate(triangle)) {
        continue;
      }
      ++triangles;
      // Each neighbour follows `a` in one triangle.
      const std::uint32_t neighbour = triangle[(local_index(triangle, a) + 1) % 3];
      common += neighbour != b && are_neighbours(neighbour, b) ? 1 : 0;
    }
    for (const std::uint32_t i : adjacency_.triangles_at(b)) {
      triangles += is_degenerate(mesh_.triangles[i]) ? 0 : 1;
    }
    // Both of the edge's triangles, counted at either end, will go.
    return common == 2 && triangles >= 4 + 3;
  }

  bool are_neighbours(std::uint32_t a, std::uint32_t b) const {
    return std::ranges::any_of(adjacency_.triangles_at(b), [&](std::uint32_t i) {
      const MeshTriangle& triangle = mesh_.triangles[i];
      return !is_degenerate(triangle) && (triangle[0] == a || triangle[1] == a || triangle[2] == a);
    });
  }

  bool flips_or_degenerates(const Collapse& collapse, std::uint32_t centre,
                            std::uint32_t other_end) const;
  void apply(const Collapse& collapse);

  Vector3 position(std::uint32_t vertex) const {
    return to_vector3(mesh_.vertices[vertex].position);
  }

  IndexedMesh& mesh_;
  std::span<const char> locked_;
  CollapseLimits limits_;
  std::vector<char> was_dirty_;
  TriangleAdjacency adjacency_;  // as the pass began
  std::vector<char> is_dirty_;
  std::vector<char> is_stale_;  // vertices whose adjacency a collapse has outdated
};

/// Whether a triangle at `centre`, but not at the other end, would turn by more than the cosine
/// allows or shrink to a sliver: a side or a height below `min_edge_mm`, or an aspect ratio above
/// `max_aspect`. Evaluates the triangle before and after the collapse in one SIMD pass.
bool CollapsePass::flips_or_degenerates(const Collapse& collapse, std::uint32_t centre,
                                        std::uint32_t other_end) const {
  constexpr double min_square = min_edge_mm * min_edge_mm;
  using BeforeAndAfter = std::array<Eigen::Array2d, 3>;
  const Vector3 before = position(centre);
  const Vector3 after = to_vector3(collapse.position);
  const BeforeAndAfter centres{Eigen::Array2d(before[0], after[0]),
                               Eigen::Array2d(before[1], after[1]),
                               Eigen::Array2d(before[2], after[2])};
  const auto side_to = [&](const Vector3& p) {
    return BeforeAndAfter{p[0] - centres[0], p[1] - centres[1], p[2] - centres[2]};
  };
  for (const std::uint32_t i : adjacency_.triangles_at(centre)) {
    const MeshTriangle& triangle = mesh_.triangles[i];
    const std::size_t at = local_index(triangle, centre);
    const std::uint32_t next = triangle[(at + 1) % 3];
    const std::uint32_t last = triangle[(at + 2) % 3];
    if (is_degenerate(triangle) || next == other_end || last == other_end) {
      continue;
    }
    const Vector3 p = position(next);
    const Vector3 q = position(last);
    const BeforeAndAfter to_p = side_to(p);
    const BeforeAndAfter to_q = side_to(q);
    const BeforeAndAfter normals = cross(to_p, to_q);
    const double along = normals[0].prod() + normals[1].prod() + normals[2].prod();
    const Eigen::Array2d squares = dot(normals, normals);
    const std::array sides{dot(to_p, to_p)[1], dot(to_q, to_q)[1], dot(q - p, q - p)};
    const double shortest = std::min({sides[0], sides[1], sides[2]});
    const double longest = std::max({sides[0], sides[1], sides[2]});
    if (along <= 0 || along * along < min_normal_cosine * min_normal_cosine * squares.prod() ||
        shortest < min_square ||
        squares[1] < longest * std::max(min_square, longest / (max_aspect * max_aspect))) {
      return true;
    }
  }
  return false;
}

void CollapsePass::apply(const Collapse& collapse) {
  // The adjacency of other vertices still holds, but for triangles that have become degenerate.
  const auto& [cost, kept, removed, position] = collapse;
  is_stale_[kept] = 1;
  is_stale_[removed] = 1;
  for (const std::uint32_t i : adjacency_.triangles_at(removed)) {
    std::ranges::replace(mesh_.triangles[i], removed, kept);
  }
  for (const std::uint32_t end : {kept, removed}) {
    for (const std::uint32_t i : adjacency_.triangles_at(end)) {
      for (const std::uint32_t corner : mesh_.triangles[i]) {
        is_dirty_[corner] = 1;
      }
    }
  }
  const std::vector<Quadric>& quadrics = mesh_.quadrics;
  mesh_.vertices[kept].position = position;
  mesh_.vertices[kept].observed =
      mesh_.vertices[quadrics[kept].area >= quadrics[removed].area ? kept : removed].observed;
  mesh_.quadrics[kept] += mesh_.quadrics[removed];
}

}  // namespace

void qem_simplify(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
                  const std::stop_token& stop) {
  // The limit rises, so that cheap collapses come first all over the mesh although the adjacency
  // is built once a pass.
  double already_tried = 0;
  std::vector<char> dirty(mesh.vertices.size(), 1);
  for (int pass = 0; pass < passes; ++pass) {
    throw_if_stopped(stop);
    const double share = std::min(1.0, (pass + 1) / full_error_pass);
    const double error = limits.target_error * share;
    CollapsePass collapses(mesh, locked, limits, std::move(dirty));
    const std::size_t done = collapses.run(error * error, already_tried);
    dirty = collapses.take_dirty();
    already_tried = error * error;
    if (done == 0 && share == 1.0) {
      break;
    }
  }
}

}  // namespace octurn
