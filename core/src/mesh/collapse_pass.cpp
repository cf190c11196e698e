#include "mesh/collapse_pass.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "parallel/radix_sort.hpp"

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

namespace {

/// Moves each collapse to where its index is in the order, along one cycle after the other: a
/// second list would be as long again.
void reorder(std::vector<Collapse>& collapses, std::vector<KeyIndex>& order) {
  for (std::uint32_t start = 0; start < order.size(); ++start) {
    const Collapse first = collapses[start];
    std::uint32_t to = start;
    for (std::uint32_t from = order[to].index; from != start; from = order[to].index) {
      collapses[to] = collapses[from];
      order[to].index = to;
      to = from;
    }
    collapses[to] = first;
    order[to].index = to;
  }
}

constexpr std::size_t prefetch_distance = 6;  // collapses
constexpr double min_edge_mm = 0.036;         // slicers weld vertices that are closer
constexpr double min_normal_cosine = 0.5;     // between a triangle's normals before and after
constexpr double max_aspect = 20;             // longest side to smallest height

/// Whether one of a triangle's edges was collapsed.
bool is_degenerate(const MeshTriangle& triangle) {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

}  // namespace

// By the upper half of the bits of their costs, which order as the costs do, as these are not
// negative; then the few that have those bits in common by the whole key.
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
    if (end - first > 1) {
      std::ranges::sort(first, end, {}, whole_key);
    }
    first = end;
  }
  reorder(collapses, keys);
  const auto end =
      std::unique(collapses.begin(), collapses.end(), [](const Collapse& a, const Collapse& b) {
        return a.kept == b.kept && a.removed == b.removed;
      });
  collapses.erase(end, collapses.end());
}

namespace {

constexpr std::size_t sampling = 16;  // vertices for each whose place counts

/// The coordinates between the strips.
std::vector<float> find_borders(std::span<const MeshVertex> vertices, std::size_t axis, int count) {
  std::vector<float> places;
  for (std::size_t i = 0; i < vertices.size(); i += sampling) {
    places.push_back(vertices[i].position[axis]);
  }
  std::ranges::sort(places);
  std::vector<float> borders;
  for (int strip = 1; strip < count && !places.empty(); ++strip) {
    borders.push_back(
        places[places.size() * static_cast<std::size_t>(strip) / static_cast<std::size_t>(count)]);
  }
  return borders;
}

}  // namespace

VertexStrips make_strips(std::span<const MeshVertex> vertices, std::size_t axis, int count,
                         ThreadTeam& team) {
  const std::vector<float> borders = find_borders(vertices, axis, count);
  VertexStrips strips(vertices.size());
  team.run([&](int thread) {
    const auto [first, end] = team.share(vertices.size(), thread);
    for (std::size_t i = first; i < end; ++i) {
      const float place = vertices[i].position[axis];
      strips[i] = static_cast<std::uint16_t>(
          std::ranges::count_if(borders, [&](float border) { return border <= place; }));
    }
  });
  return strips;
}

/// What one thread does among others: the collapses between vertices of one strip.
class CollapsePass::Strip {
 public:
  Strip(CollapsePass& pass, const StripReach& reach) : pass_(pass), reach_(reach) {}

  /// Those of some lists that have an end in the strip.
  Collapses gather(const std::vector<Collapses>& lists) const {
    Collapses own;
    for (const Collapses& list : lists) {
      std::ranges::copy_if(list, std::back_inserter(own), [&](const Collapse& collapse) {
        return reach_.has(collapse.kept) || reach_.has(collapse.removed);
      });
    }
    sort_by_cost(own);
    return own;
  }

  /// @param left  the collapses that were left, in their order
  /// @returns how many edges were collapsed
  std::size_t run(const Collapses& collapses, Collapses& left) {
    std::size_t done = 0;
    for (std::size_t i = 0; i < collapses.size(); ++i) {
      const Collapse& collapse = collapses[i];
      pass_.prefetch(collapses[std::min(i + prefetch_distance, collapses.size() - 1)]);
      if (is_stale(collapse.kept) || is_stale(collapse.removed)) {
        continue;
      }
      if (!reach_.is_within(collapse.kept) || !reach_.is_within(collapse.removed)) {
        reach_.leave_around(collapse.kept);
        reach_.leave_around(collapse.removed);
        left.push_back(collapse);
      } else if (pass_.make_if_valid(collapse)) {
        ++done;
      }
    }
    return done;
  }

 private:
  bool is_stale(std::uint32_t vertex) const {
    return reach_.has(vertex) && pass_.is_stale_[vertex] != 0;
  }

  CollapsePass& pass_;
  StripReach reach_;
};

std::size_t CollapsePass::run(double max_cost, double already_tried,
                              std::span<const VertexStrips> tilings) {
  std::vector<Collapses> lists(static_cast<std::size_t>(team_.size()));
  team_.run([&](int thread) {
    const auto [first, end] = team_.share(mesh_.triangles.size(), thread);
    lists[static_cast<std::size_t>(thread)] = list_collapses(
        std::span(mesh_.triangles).subspan(first, end - first), max_cost, already_tried);
  });
  std::size_t done = 0;
  for (const VertexStrips& strips : tilings) {
    done += collapse_in_strips(strips, lists);
  }
  Collapses left = std::move(lists.front());
  for (std::size_t i = 1; i < lists.size(); ++i) {
    left.insert(left.end(), lists[i].begin(), lists[i].end());
  }
  sort_by_cost(left);
  done += collapse_all(left);
  std::erase_if(mesh_.triangles, is_degenerate);
  return done;
}

/// @param lists  of collapses; then those that were left
std::size_t CollapsePass::collapse_in_strips(const VertexStrips& strips,
                                             std::vector<Collapses>& lists) {
  std::vector<Reach> reach(mesh_.vertices.size(), Reach::unknown);
  std::vector<Collapses> left(lists.size());
  std::vector<std::size_t> done(lists.size());
  team_.run([&](int thread) {
    Strip strip(*this, {mesh_.triangles, adjacency_, strips, thread, reach});
    const auto i = static_cast<std::size_t>(thread);
    done[i] = strip.run(strip.gather(lists), left[i]);
  });
  lists = std::move(left);
  return std::reduce(done.begin(), done.end());
}

std::size_t CollapsePass::collapse_all(const Collapses& collapses) {
  std::size_t done = 0;
  for (std::size_t i = 0; i < collapses.size(); ++i) {
    const Collapse& collapse = collapses[i];
    prefetch(collapses[std::min(i + prefetch_distance, collapses.size() - 1)]);
    if (is_stale_[collapse.kept] == 0 && is_stale_[collapse.removed] == 0 &&
        make_if_valid(collapse)) {
      ++done;
    }
  }
  return done;
}

CollapsePass::Collapses CollapsePass::list_collapses(std::span<const MeshTriangle> triangles,
                                                     double max_cost, double already_tried) const {
  Collapses collapses;
  for (const MeshTriangle& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      // A closed mesh has each edge once in either direction.
      if (a < b && locked_[a] == 0 && locked_[b] == 0) {
        const bool is_known = was_dirty_[a] == 0 && was_dirty_[b] == 0;
        if (is_known && max_cost <= already_tried) {
          continue;
        }
        Quadric sum = mesh_.quadrics[a];
        sum += mesh_.quadrics[b];
        const double cost = sum.mean_square(to_vector3(optimum(a, b, sum)));
        if (cost <= max_cost && !(is_known && cost <= already_tried)) {
          collapses.push_back({.cost = cost, .kept = a, .removed = b});
        }
      }
    }
  }
  return collapses;
}

/// Position of the merged vertex. @param sum  of the quadrics of both
CollapsePass::Position CollapsePass::optimum(std::uint32_t a, std::uint32_t b,
                                             const Quadric& sum) const {
  const Vector3 from = position(a);
  const Vector3 to = position(b);
  const Vector3 middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (from[2] + to[2]) / 2};
  const bool is_on_platform = from[2] == 0 || to[2] == 0;
  const Vector3 best = is_on_platform ? sum.optimum_on_platform(middle) : sum.optimum(middle);
  return {static_cast<float>(best[0]), static_cast<float>(best[1]), static_cast<float>(best[2])};
}

/// Collapses are spread over the mesh by their order, and the mesh does not fit in the cache.
void CollapsePass::prefetch(const Collapse& collapse) const {
  for (const std::uint32_t end : {collapse.kept, collapse.removed}) {
    __builtin_prefetch(&mesh_.vertices[end]);
    __builtin_prefetch(&mesh_.quadrics[end]);
    __builtin_prefetch(&mesh_.triangles[adjacency_.triangles_at(end).front()]);
    __builtin_prefetch(&mesh_.triangles[adjacency_.triangles_at(end).back()]);
  }
}

/// @param collapse  of ends that are as they were when it was listed
/// @returns whether it was valid, and was made
bool CollapsePass::make_if_valid(const Collapse& collapse) {
  const auto& [cost, a, b] = collapse;
  Quadric sum = mesh_.quadrics[a];
  sum += mesh_.quadrics[b];
  const Position to = optimum(a, b, sum);
  // In this order, as flips refuse half of all collapses and the link condition next to none.
  if (to[2] < limits_.min_z || to[2] > limits_.max_z || flips_or_degenerates(to, a, b) ||
      flips_or_degenerates(to, b, a) || !meets_link_condition(a, b)) {
    return false;
  }
  apply(collapse, to, sum);
  return true;
}

/// Whether the ends have just the two neighbours in common that face the edge, and the vertex
/// that is kept will have three triangles or more.
bool CollapsePass::meets_link_condition(std::uint32_t a, std::uint32_t b) const {
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

bool CollapsePass::are_neighbours(std::uint32_t a, std::uint32_t b) const {
  return std::ranges::any_of(adjacency_.triangles_at(b), [&](std::uint32_t i) {
    const MeshTriangle& triangle = mesh_.triangles[i];
    return !is_degenerate(triangle) && (triangle[0] == a || triangle[1] == a || triangle[2] == a);
  });
}

/// Whether a triangle at `centre`, but not at the other end, would turn by more than the cosine
/// allows or shrink to a sliver: a side or a height below `min_edge_mm`, or an aspect ratio above
/// `max_aspect`. Evaluates the triangle before and after the collapse in one SIMD pass.
bool CollapsePass::flips_or_degenerates(const Position& to, std::uint32_t centre,
                                        std::uint32_t other_end) const {
  constexpr double min_square = min_edge_mm * min_edge_mm;
  using BeforeAndAfter = std::array<Eigen::Array2d, 3>;
  const Vector3 before = position(centre);
  const Vector3 after = to_vector3(to);
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

void CollapsePass::apply(const Collapse& collapse, const Position& position, const Quadric& sum) {
  // The adjacency of other vertices still holds, but for triangles that have become degenerate.
  const auto& [cost, kept, removed] = collapse;
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
  mesh_.quadrics[kept] = sum;
}

}  // namespace octurn
