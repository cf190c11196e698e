#include "mesh/indexed_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/triangle_chunks.hpp"
#include "mesh/vector3.hpp"

namespace octurn {
namespace {

/// Adds the planes of triangles to the quadrics of the vertices from `first` to `end`.
void add_plane_quadrics_of(IndexedMesh& mesh, const TriangleChunks& triangles, std::size_t first,
                           std::size_t end) {
  const auto is_own = [&](std::uint32_t vertex) { return vertex - first < end - first; };
  triangles.for_each(first, end, [&](std::size_t, const MeshTriangle& triangle) {
    if (std::ranges::none_of(triangle, is_own)) {
      return;
    }
    const Vector3 a = to_vector3(mesh.vertices[triangle[0]].position);
    const Vector3 normal = area_normal(a, to_vector3(mesh.vertices[triangle[1]].position),
                                       to_vector3(mesh.vertices[triangle[2]].position));
    const double twice_area = std::sqrt(dot(normal, normal));
    if (twice_area == 0) {
      return;  // of no plane
    }
    const Vector3 unit{normal[0] / twice_area, normal[1] / twice_area, normal[2] / twice_area};
    const Quadric quadric = plane_quadric(unit, -dot(unit, a), twice_area / 2);
    for (const std::uint32_t corner : triangle) {
      if (is_own(corner)) {
        mesh.quadrics[corner] += quadric;
      }
    }
  });
}

}  // namespace

void add_plane_quadrics(IndexedMesh& mesh, std::size_t first, ThreadTeam& team) {
  mesh.quadrics.resize(mesh.vertices.size());
  const std::span<const MeshTriangle> triangles = std::span(mesh.triangles).subspan(first);
  if (triangles.empty()) {
    return;
  }
  const TriangleChunks chunks(triangles, team);
  const std::uint32_t low = chunks.low();
  team.run([&](int thread) {
    const auto [from, to] = team.share(mesh.vertices.size() - low, thread);
    add_plane_quadrics_of(mesh, chunks, low + from, low + to);
  });
}

std::vector<std::uint32_t> compact(IndexedMesh& mesh, std::span<const std::uint32_t> also_used) {
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), removed_vertex);
  const auto use = [&](std::uint32_t vertex) { new_index[vertex] = 0; };
  for (const MeshTriangle& triangle : mesh.triangles) {
    std::ranges::for_each(triangle, use);
  }
  std::ranges::for_each(also_used, use);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (new_index[i] != removed_vertex) {
      mesh.vertices[next] = mesh.vertices[i];
      mesh.quadrics[next] = mesh.quadrics[i];
      new_index[i] = next++;
    }
  }
  mesh.vertices.resize(next);
  mesh.quadrics.resize(next);
  for (MeshTriangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = new_index[corner];
    }
  }
  return new_index;
}

}  // namespace octurn
