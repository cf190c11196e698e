#include "mesh/stream_simplifier.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "mesh/self_intersections.hpp"

namespace octurn {
namespace {

constexpr std::size_t window_triangles = 30'000;
constexpr float first_reach_mm = 0.5F;  // around an intersection, where vertices are locked

Aabb make_cube(const std::array<float, 3>& centre, float reach) {
  return {.min = {centre[0] - reach, centre[1] - reach, centre[2] - reach},
          .max = {centre[0] + reach, centre[1] + reach, centre[2] + reach}};
}

std::vector<Aabb> find_self_intersections(const IndexedMesh& mesh, std::size_t already_checked,
                                          ThreadTeam& team) {
  std::vector<std::array<float, 3>> positions(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, positions.begin(), &MeshVertex::position);
  return self_intersections(positions, mesh.triangles, already_checked, team);
}

}  // namespace

StreamSimplifier::StreamSimplifier(double target_error, double margin, FacetSink sink,
                                   std::stop_token stop, ThreadTeam& team)
    : limits_{.target_error = target_error},
      margin_(margin),
      sink_(std::move(sink)),
      stop_(std::move(stop)),
      team_(team) {}

void StreamSimplifier::add(const MeshPiece& piece) {
  // The last piece becomes the last but one, whose surface this piece completes.
  window_.erase(window_.begin(), window_.begin() + (last_piece_ - first_piece_));
  first_piece_ = last_piece_;
  for (const std::uint32_t index : window_) {
    locked_[index] = mesh_.vertices[index].fixed ? 1 : 0;
  }
  last_piece_ = first_piece_ + static_cast<std::uint32_t>(window_.size());
  for (const MeshVertex& vertex : piece.vertices) {
    window_.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
    mesh_.vertices.push_back(vertex);
  }
  locked_.resize(mesh_.vertices.size(), 1);
  for (const MeshTriangle& triangle : piece.triangles) {
    mesh_.triangles.push_back({window_[triangle[0] - first_piece_],
                               window_[triangle[1] - first_piece_],
                               window_[triangle[2] - first_piece_]});
  }
  added_ += piece.triangles.size();
  if (added_ >= window_triangles) {
    limits_.max_z = std::numeric_limits<float>::lowest();
    for (const std::uint32_t index : window_) {
      limits_.max_z = std::max(limits_.max_z, mesh_.vertices[index].position[2]);
    }
    simplify();
    flush_below(limits_.max_z - static_cast<float>(margin_));
    added_ = 0;
  }
}

void StreamSimplifier::finish() {
  for (const std::uint32_t index : window_) {
    locked_[index] = mesh_.vertices[index].fixed ? 1 : 0;
  }
  window_.clear();
  limits_.max_z = std::numeric_limits<float>::max();
  simplify();
  flush_below(std::numeric_limits<float>::max());
}

/// A copy of the window, in which the vertices that were added have their quadrics. The window
/// itself does without, as they are most of its memory.
IndexedMesh StreamSimplifier::with_all_quadrics() const {
  IndexedMesh copy{.vertices = mesh_.vertices, .quadrics = {}, .triangles = mesh_.triangles};
  copy.quadrics.reserve(copy.vertices.size());
  copy.quadrics = mesh_.quadrics;
  add_plane_quadrics(copy, copy.triangles.size() - added_, team_);
  return copy;
}

/// Simplifies the window so that it does not intersect itself. The added pieces do not intersect
/// themselves, so that locking more and more vertices terminates.
void StreamSimplifier::simplify() {
  for (float reach = first_reach_mm;;) {
    IndexedMesh simplified = with_all_quadrics();
    qem_simplify(simplified, locked_, limits_, stop_, team_);
    const std::vector<Aabb> intersections = find_self_intersections(simplified, flushed_, team_);
    if (intersections.empty() || simplified.triangles.size() == mesh_.triangles.size()) {
      mesh_ = std::move(simplified);
      return;
    }
    if (!lock_near(intersections, reach)) {
      reach *= 2;
    }
  }
}

/// @param reach  millimetres, along each axis
/// @returns whether any of the vertices near the boxes was not locked yet
bool StreamSimplifier::lock_near(const std::vector<Aabb>& boxes, float reach) {
  bool is_any_new = false;
  for (std::size_t i = 0; i < locked_.size(); ++i) {
    const Aabb cube = make_cube(mesh_.vertices[i].position, reach);
    if (locked_[i] == 0 &&
        std::ranges::any_of(boxes, [&](const Aabb& box) { return box.overlaps(cube); })) {
      locked_[i] = 1;
      is_any_new = true;
    }
  }
  return is_any_new;
}

/// Emits the triangles that lie entirely below `end`, and removes those that no other triangle can
/// meet.
void StreamSimplifier::flush_below(float end) {
  std::vector<MeshTriangle>& triangles = mesh_.triangles;
  const auto lies_below = [&](float z) {
    return [this, z](const MeshTriangle& triangle) {
      return std::ranges::all_of(
          triangle, [&](std::uint32_t c) { return mesh_.vertices[c].position[2] < z; });
    };
  };
  const auto emitted = triangles.begin() + static_cast<std::ptrdiff_t>(flushed_);
  const auto rest = std::stable_partition(emitted, triangles.end(), lies_below(end));
  emit({emitted, rest});
  limits_.min_z = std::numeric_limits<float>::max();
  std::for_each(rest, triangles.end(), [&](const MeshTriangle& triangle) {
    for (const std::uint32_t corner : triangle) {
      limits_.min_z = std::min(limits_.min_z, mesh_.vertices[corner].position[2]);
    }
  });
  // Emitted triangles that reach higher stay as obstacles.
  const auto obstacles_end = std::remove_if(triangles.begin(), rest, lies_below(limits_.min_z));
  flushed_ = static_cast<std::size_t>(obstacles_end - triangles.begin());
  triangles.erase(obstacles_end, rest);
  compact_window();
}

/// Hands triangles to the sink and locks their vertices.
void StreamSimplifier::emit(std::span<const MeshTriangle> triangles) {
  std::vector<Facet> facets;
  facets.reserve(triangles.size());
  for (const MeshTriangle& triangle : triangles) {
    const auto& [a, b, c] = triangle;
    facets.push_back(to_facet({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]}));
    for (const std::uint32_t corner : triangle) {
      locked_[corner] = 1;
    }
  }
  if (!facets.empty()) {
    sink_(facets);
  }
}

void StreamSimplifier::compact_window() {
  const std::vector<std::uint32_t> new_index = compact(mesh_, window_);
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] != removed_vertex) {
      locked_[new_index[i]] = locked_[i];
    }
  }
  locked_.resize(mesh_.vertices.size());
  for (std::uint32_t& index : window_) {
    index = new_index[index];
  }
}

}  // namespace octurn
