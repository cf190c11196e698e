#include "mesh/indexed_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/vector3.hpp"

namespace octurn {

void add_plane_quadrics(IndexedMesh& mesh, std::size_t first) {
  for (std::size_t i = first; i < mesh.triangles.size(); ++i) {
    const MeshTriangle& triangle = mesh.triangles[i];
    const Vector3 a = to_vector3(mesh.vertices[triangle[0]].position);
    const Vector3 normal = area_normal(a, to_vector3(mesh.vertices[triangle[1]].position),
                                       to_vector3(mesh.vertices[triangle[2]].position));
    const double twice_area = std::sqrt(dot(normal, normal));
    if (twice_area == 0) {
      continue;  // of no plane
    }
    const Vector3 unit{normal[0] / twice_area, normal[1] / twice_area, normal[2] / twice_area};
    const Quadric quadric = plane_quadric(unit, -dot(unit, a), twice_area / 2);
    for (const std::uint32_t corner : triangle) {
      mesh.quadrics[corner] += quadric;
    }
  }
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
