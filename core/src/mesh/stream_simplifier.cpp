#include "mesh/stream_simplifier.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "mesh/self_intersections.hpp"
#include "mesh/vector3.hpp"
#include "octurn/snapshot.hpp"
#include "parallel/radix_sort.hpp"

namespace octurn {
namespace {

constexpr int passes = 6;
constexpr std::size_t window_triangles = 30'000;
constexpr std::size_t collapses_ahead = 6;  // of the one that is tried, to be fetched from memory
constexpr double least_edge_mm = 0.036;     // slicers meld vertices that are closer
constexpr double least_turn = 0.5;          // cosine between a triangle's normals before and after
constexpr float first_reach_mm = 0.5F;      // around a cut, where the surface is left as it was

/// A box with a point in its middle.
Aabb around(const std::array<float, 3>& point, float reach) {
  return {.low = {point[0] - reach, point[1] - reach, point[2] - reach},
          .high = {point[0] + reach, point[1] + reach, point[2] + reach}};
}

/// Whether a triangle's edge was collapsed.
bool is_degenerate(const MeshTriangle& triangle) {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

}  // namespace

StreamSimplifier::StreamSimplifier(double target_error, double margin, FacetSink sink,
                                   std::stop_token stop)
    : target_error_(target_error),
      margin_(margin),
      sink_(std::move(sink)),
      stop_(std::move(stop)) {}

void StreamSimplifier::add(const MeshPiece& piece) {
  // Only the vertices of the last piece may be met again.
  names_.erase(names_.begin(), names_.begin() + (last_piece_ - first_name_));
  first_name_ = last_piece_;
  for (const std::uint32_t name : names_) {
    vertices_[name].fixed = false;
  }
  last_piece_ = first_name_ + static_cast<std::uint32_t>(names_.size());
  for (const MeshVertex& vertex : piece.vertices) {
    names_.push_back(static_cast<std::uint32_t>(vertices_.size()));
    vertices_.push_back({.position = vertex.position, .seen = vertex.seen, .fixed = true});
  }
  quadrics_.resize(vertices_.size());
  const std::size_t first = triangles_.size();
  for (const MeshTriangle& triangle : piece.triangles) {
    triangles_.push_back({names_[triangle[0] - first_name_], names_[triangle[1] - first_name_],
                          names_[triangle[2] - first_name_]});
  }
  add_quadrics(first);
  fresh_ += piece.triangles.size();
  if (fresh_ >= window_triangles) {
    top_ = 0;
    for (const std::uint32_t name : names_) {
      top_ = std::max(top_, vertices_[name].position[2]);
    }
    simplify();
    flush_below(top_ - static_cast<float>(margin_));
    fresh_ = 0;
  }
}

void StreamSimplifier::finish() {
  for (const std::uint32_t name : names_) {
    vertices_[name].fixed = false;
  }
  names_.clear();
  top_ = std::numeric_limits<float>::max();
  simplify();
  flush_below(std::numeric_limits<float>::max());
}

void StreamSimplifier::add_quadrics(std::size_t first_triangle) {
  for (std::size_t i = first_triangle; i < triangles_.size(); ++i) {
    const MeshTriangle& triangle = triangles_[i];
    const Vector3 a = vector_of(vertices_[triangle[0]].position);
    const Vector3 normal = normal_of(a, vector_of(vertices_[triangle[1]].position),
                                     vector_of(vertices_[triangle[2]].position));
    const double twice_area = std::sqrt(dot(normal, normal));
    if (twice_area == 0) {
      continue;
    }
    const Vector3 n{normal[0] / twice_area, normal[1] / twice_area, normal[2] / twice_area};
    const double d = -dot(n, a);
    const double area = twice_area / 2;
    const std::array terms{n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2],
                           n[2] * n[2], n[0] * d,    n[1] * d,    n[2] * d,    d * d};
    for (const std::uint32_t corner : triangle) {
      Quadric& quadric = quadrics_[corner];
      for (std::size_t term = 0; term < terms.size(); ++term) {
        quadric.terms[term] += area * terms[term];
      }
      quadric.area += area;
    }
  }
}

/// Collapses edges; where that makes the surface cut itself, does it again with the vertices around
/// there fixed. What is handed on as it came does not cut itself (see `marching_cubes`).
void StreamSimplifier::simplify() {
  const std::vector<Vertex> vertices = vertices_;
  const std::vector<Quadric> quadrics = quadrics_;
  const std::vector<MeshTriangle> triangles = triangles_;
  for (float reach = first_reach_mm;;) {
    collapse_edges();
    std::vector<std::array<float, 3>> positions(vertices.size());
    std::ranges::transform(vertices_, positions.begin(), &Vertex::position);
    const std::vector<Aabb> cuts = self_intersections(positions, triangles_, flushed_);
    if (cuts.empty() || triangles_.size() == triangles.size()) {
      return;
    }
    bool any = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const bool was_fixed = vertices_[i].fixed;
      vertices_[i] = vertices[i];
      const Aabb place = around(vertices[i].position, reach);
      vertices_[i].fixed =
          was_fixed || std::ranges::any_of(cuts, [&](const Aabb& cut) { return cut.meets(place); });
      any = any || vertices_[i].fixed != was_fixed;
    }
    quadrics_ = quadrics;
    triangles_ = triangles;
    reach = any ? reach : 2 * reach;
  }
}

void StreamSimplifier::collapse_edges() {
  // The limit rises, so that what costs little goes first, all over the window.
  double refused = 0;  // what costs no more was tried in the last pass; at first all has changed
  changed_.assign(vertices_.size(), 1);
  for (int pass = 0; pass < passes; ++pass) {
    throw_if_stopped(stop_);
    const double share = std::min(1.0, (pass + 1) / (0.6 * passes));
    const double error = target_error_ * share;
    corners_.assign(triangles_, vertices_.size());
    list_collapses(error * error, refused);
    refused = error * error;
    touched_.assign(vertices_.size(), 0);
    changed_.assign(vertices_.size(), 0);
    std::size_t done = 0;
    for (std::size_t i = 0; i < collapses_.size(); ++i) {
      const Collapse& collapse = collapses_[i];
      prefetch(collapses_[std::min(i + collapses_ahead, collapses_.size() - 1)]);
      if (touched_[collapse.kept] == 0 && touched_[collapse.gone] == 0 && may_collapse(collapse)) {
        apply(collapse);
        ++done;
      }
    }
    drop_collapsed();
    if (done == 0 && share == 1.0) {
      break;
    }
  }
}

/// @param refused  limit of the last pass: where no triangle around has changed since, it would
///                 refuse the same
void StreamSimplifier::list_collapses(double limit, double refused) {
  collapses_.clear();
  for (const MeshTriangle& triangle : triangles_) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      // Each edge is met once in either direction.
      if (a < b && !vertices_[a].fixed && !vertices_[b].fixed) {
        const bool is_known = changed_[a] == 0 && changed_[b] == 0;
        if (is_known && limit <= refused) {
          continue;
        }
        const Collapse collapse = collapse_of(a, b);
        if (collapse.cost <= limit && !(is_known && collapse.cost <= refused)) {
          collapses_.push_back(collapse);
        }
      }
    }
  }
  sort_collapses();
}

/// The cheapest first: by the upper half of the bits of their costs, which rise with them; then
/// those that have these in common, which are few.
void StreamSimplifier::sort_collapses() {
  std::vector<KeyIndex> places;
  places.reserve(collapses_.size());
  for (const Collapse& collapse : collapses_) {
    places.push_back(
        {.key = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(collapse.cost) >> 32),
         .index = static_cast<std::uint32_t>(places.size())});
  }
  radix_sort(places, 32);
  const auto order = [&](const KeyIndex& place) {
    const Collapse& collapse = collapses_[place.index];
    return std::tuple(collapse.cost, collapse.kept, collapse.gone);
  };
  for (auto first = places.begin(); first != places.end();) {
    const auto end = std::find_if(first, places.end(),
                                  [&](const KeyIndex& place) { return place.key != first->key; });
    std::ranges::sort(first, end, {}, order);
    first = end;
  }
  std::vector<Collapse> ordered;
  ordered.reserve(places.size());
  for (const KeyIndex& place : places) {
    ordered.push_back(collapses_[place.index]);
  }
  collapses_.swap(ordered);
}

/// The collapse of an edge to where the squared distance to its planes is least.
StreamSimplifier::Collapse StreamSimplifier::collapse_of(std::uint32_t a, std::uint32_t b) const {
  Quadric sum = quadrics_[a];
  sum += quadrics_[b];
  const auto& [xx, xy, xz, yy, yz, zz, xd, yd, zd, dd] = sum.terms;
  const auto cost_at = [&sum](const Vector3& p) {
    const auto& t = sum.terms;
    return p[0] * (t[0] * p[0] + 2 * (t[1] * p[1] + t[2] * p[2] + t[6])) +
           p[1] * (t[3] * p[1] + 2 * (t[4] * p[2] + t[7])) + p[2] * (t[5] * p[2] + 2 * t[8]) + t[9];
  };
  const Vector3 from = vector_of(vertices_[a].position);
  const Vector3 to = vector_of(vertices_[b].position);
  const Vector3 middle{(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (from[2] + to[2]) / 2};
  // The foot stays on the platform.
  const bool stands = from[2] == 0 || to[2] == 0;
  // Along directions that the planes leave open, the middle of the edge.
  const double hold = 1e-3 * sum.area;
  const double axx = xx + hold;
  const double ayy = yy + hold;
  const double azz = zz + hold;
  const double bx = hold * middle[0] - xd;
  const double by = hold * middle[1] - yd;
  const double bz = hold * middle[2] - zd;
  Vector3 best = middle;
  if (stands) {
    const double det = axx * ayy - xy * xy;
    best = {(bx * ayy - by * xy) / det, (by * axx - bx * xy) / det, 0.0};
  } else {
    const double c0 = ayy * azz - yz * yz;
    const double c1 = xz * yz - xy * azz;
    const double c2 = xy * yz - xz * ayy;
    const double det = axx * c0 + xy * c1 + xz * c2;
    best = {(bx * c0 + by * c1 + bz * c2) / det,
            (bx * c1 + by * (axx * azz - xz * xz) + bz * (xy * xz - axx * yz)) / det,
            (bx * c2 + by * (xy * xz - axx * yz) + bz * (axx * ayy - xy * xy)) / det};
  }
  Collapse collapse{.cost = 0,
                    .kept = a,
                    .gone = b,
                    .position = {static_cast<float>(best[0]), static_cast<float>(best[1]),
                                 static_cast<float>(best[2])}};
  collapse.cost = std::max(0.0, cost_at(vector_of(collapse.position)) / sum.area);
  return collapse;
}

/// They come from all over the window, which does not fit in the cache.
void StreamSimplifier::prefetch(const Collapse& collapse) const {
  for (const std::uint32_t end : {collapse.kept, collapse.gone}) {
    __builtin_prefetch(&vertices_[end]);
    __builtin_prefetch(&quadrics_[end]);
    __builtin_prefetch(&triangles_[corners_.triangles_of(end).front()]);
    __builtin_prefetch(&triangles_[corners_.triangles_of(end).back()]);
  }
}

bool StreamSimplifier::may_collapse(const Collapse& collapse) const {
  const auto& [cost, a, b, position] = collapse;
  // Beyond may lie what was handed on long ago, or is still to come.
  if (position[2] < bottom_ || position[2] > top_) {
    return false;
  }
  // Refuses half of all collapses; the link condition, next to none.
  if (flips_or_degenerates(collapse, a, b) || flips_or_degenerates(collapse, b, a)) {
    return false;
  }
  // The link condition: the ends have just the two neighbours in common that face the edge.
  int common = 0;
  std::size_t around = 0;
  for (const std::uint32_t i : corners_.triangles_of(a)) {
    const MeshTriangle& triangle = triangles_[i];
    if (is_degenerate(triangle)) {
      continue;
    }
    ++around;
    const std::size_t at = local_index(triangle, a);
    const std::uint32_t neighbour = triangle[(at + 1) % 3];  // each follows `a` in one triangle
    common += neighbour != b && are_neighbours(neighbour, b) ? 1 : 0;
  }
  // Around the end that stays there must be three triangles or more when two are gone.
  for (const std::uint32_t i : corners_.triangles_of(b)) {
    around += is_degenerate(triangles_[i]) ? 0 : 1;
  }
  return common == 2 && around > 6;
}

/// Whether a live triangle at `b` has the corner `a`.
bool StreamSimplifier::are_neighbours(std::uint32_t a, std::uint32_t b) const {
  return std::ranges::any_of(corners_.triangles_of(b), [&](std::uint32_t i) {
    const MeshTriangle& triangle = triangles_[i];
    return !is_degenerate(triangle) && (triangle[0] == a || triangle[1] == a || triangle[2] == a);
  });
}

/// Whether a triangle around one end, but not the other, would turn over or shrink to a sliver: a
/// side or a height below a slicer's grain, or a height below a twentieth of the longest side.
bool StreamSimplifier::flips_or_degenerates(const Collapse& collapse, std::uint32_t around,
                                            std::uint32_t other) const {
  constexpr double least_square = least_edge_mm * least_edge_mm;
  using BeforeAndAfter = std::array<Eigen::Array2d, 3>;
  const Vector3 from = vector_of(vertices_[around].position);
  const Vector3 to = vector_of(collapse.position);
  const BeforeAndAfter ends{Eigen::Array2d(from[0], to[0]), Eigen::Array2d(from[1], to[1]),
                            Eigen::Array2d(from[2], to[2])};
  const auto side_to = [&](const Vector3& p) {
    return BeforeAndAfter{p[0] - ends[0], p[1] - ends[1], p[2] - ends[2]};
  };
  for (const std::uint32_t i : corners_.triangles_of(around)) {
    const MeshTriangle& triangle = triangles_[i];
    const std::size_t at = local_index(triangle, around);
    const std::uint32_t next = triangle[(at + 1) % 3];
    const std::uint32_t last = triangle[(at + 2) % 3];
    if (is_degenerate(triangle) || next == other || last == other) {
      continue;
    }
    const Vector3 p = vector_of(vertices_[next].position);
    const Vector3 q = vector_of(vertices_[last].position);
    const BeforeAndAfter to_p = side_to(p);
    const BeforeAndAfter to_q = side_to(q);
    const BeforeAndAfter normals = cross(to_p, to_q);
    const double along = normals[0].prod() + normals[1].prod() + normals[2].prod();
    const Eigen::Array2d squares = dot(normals, normals);
    const std::array sides{dot(to_p, to_p)[1], dot(to_q, to_q)[1], dot(q - p, q - p)};
    const double shortest = std::min({sides[0], sides[1], sides[2]});
    const double longest = std::max({sides[0], sides[1], sides[2]});
    if (along <= 0 || along * along < least_turn * least_turn * squares.prod() ||
        shortest < least_square || squares[1] < longest * std::max(least_square, longest / 400)) {
      return true;
    }
  }
  return false;
}

void StreamSimplifier::apply(const Collapse& collapse) {
  // The lists of triangles at other vertices still hold, but for triangles that are gone.
  touched_[collapse.kept] = 1;
  touched_[collapse.gone] = 1;
  for (const std::uint32_t i : corners_.triangles_of(collapse.gone)) {
    std::ranges::replace(triangles_[i], collapse.gone, collapse.kept);
  }
  for (const std::uint32_t end : {collapse.kept, collapse.gone}) {
    for (const std::uint32_t i : corners_.triangles_of(end)) {
      for (const std::uint32_t corner : triangles_[i]) {
        changed_[corner] = 1;
      }
    }
  }
  const auto& [cost, kept, gone, position] = collapse;
  vertices_[kept].position = position;
  vertices_[kept].seen = vertices_[quadrics_[kept].area >= quadrics_[gone].area ? kept : gone].seen;
  quadrics_[kept] += quadrics_[gone];
}

void StreamSimplifier::drop_collapsed() { std::erase_if(triangles_, is_degenerate); }

/// Hands on the triangles that lie below `end` as a whole, and forgets what is no longer needed.
void StreamSimplifier::flush_below(float end) {
  facets_.clear();
  const auto height = [&](std::uint32_t corner) { return vertices_[corner].position[2]; };
  const auto rest = std::stable_partition(
      triangles_.begin() + static_cast<std::ptrdiff_t>(flushed_), triangles_.end(),
      [&](const MeshTriangle& triangle) {
        return std::ranges::all_of(triangle, [&](std::uint32_t c) { return height(c) < end; });
      });
  bottom_ = std::numeric_limits<float>::max();
  std::for_each(rest, triangles_.end(), [&](const MeshTriangle& triangle) {
    for (const std::uint32_t corner : triangle) {
      bottom_ = std::min(bottom_, height(corner));
    }
  });
  std::for_each(triangles_.begin() + static_cast<std::ptrdiff_t>(flushed_), rest,
                [&](const MeshTriangle& triangle) {
                  std::array<MeshVertex, 3> corners{};
                  for (std::size_t i = 0; i < 3; ++i) {
                    Vertex& vertex = vertices_[triangle[i]];
                    corners[i] = {.position = vertex.position, .seen = vertex.seen};
                    vertex.fixed = true;
                  }
                  facets_.push_back(to_facet(corners));
                });
  if (!facets_.empty()) {
    sink_(facets_);
  }
  // What the rest could still be made to cut stays.
  const auto left = std::remove_if(triangles_.begin(), rest, [&](const MeshTriangle& triangle) {
    return std::ranges::all_of(triangle, [&](std::uint32_t c) { return height(c) < bottom_; });
  });
  flushed_ = static_cast<std::size_t>(left - triangles_.begin());
  triangles_.erase(left, rest);
  std::vector<std::uint32_t> moved(vertices_.size(), std::numeric_limits<std::uint32_t>::max());
  std::uint32_t next = 0;
  const auto keep = [&](std::uint32_t vertex) { moved[vertex] = 0; };
  for (const MeshTriangle& triangle : triangles_) {
    std::ranges::for_each(triangle, keep);
  }
  std::ranges::for_each(names_, keep);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (moved[i] == 0) {
      moved[i] = next;
      vertices_[next] = vertices_[i];
      quadrics_[next++] = quadrics_[i];
    }
  }
  vertices_.resize(next);
  quadrics_.resize(next);
  for (MeshTriangle& triangle : triangles_) {
    for (std::uint32_t& corner : triangle) {
      corner = moved[corner];
    }
  }
  for (std::uint32_t& name : names_) {
    name = moved[name];
  }
}

}  // namespace octurn
