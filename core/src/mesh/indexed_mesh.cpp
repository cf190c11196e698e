#include "mesh/indexed_mesh.hpp"

#include <cmath>

#include "mesh/triangle_adjacency.hpp"

namespace octurn {
namespace {

/// Weight of the squared distance to the guess, as a share of the planes' weight: small beside
/// them, large beside rounding (Tikhonov regularisation).
constexpr double regularisation = 1e-3;

/// The regularised normal equations, (A + r I) p = r guess - b.
struct NormalEquations {
  double xx, yy, zz;  // of the matrix's diagonal; the rest is A's
  Vector3 right;
};

NormalEquations make_normal_equations(const Quadric& quadric, const Vector3& guess) {
  const auto& [xx, xy, xz, yy, yz, zz, x, y, z, c] = quadric.terms;
  const double weight = regularisation * quadric.area;
  return {.xx = xx + weight,
          .yy = yy + weight,
          .zz = zz + weight,
          .right = {weight * guess[0] - x, weight * guess[1] - y, weight * guess[2] - z}};
}

}  // namespace

Vector3 Quadric::optimum(const Vector3& guess) const {
  const double xy = terms[1];
  const double xz = terms[2];
  const double yz = terms[4];
  const auto [xx, yy, zz, right] = make_normal_equations(*this, guess);
  // Cramer's rule, by the cofactors of the symmetric matrix.
  const double cofactor_xx = yy * zz - yz * yz;
  const double cofactor_xy = xz * yz - xy * zz;
  const double cofactor_xz = xy * yz - xz * yy;
  const double cofactor_yy = xx * zz - xz * xz;
  const double cofactor_yz = xy * xz - xx * yz;
  const double cofactor_zz = xx * yy - xy * xy;
  const double determinant = xx * cofactor_xx + xy * cofactor_xy + xz * cofactor_xz;
  return {(right[0] * cofactor_xx + right[1] * cofactor_xy + right[2] * cofactor_xz) / determinant,
          (right[0] * cofactor_xy + right[1] * cofactor_yy + right[2] * cofactor_yz) / determinant,
          (right[0] * cofactor_xz + right[1] * cofactor_yz + right[2] * cofactor_zz) / determinant};
}

Vector3 Quadric::optimum_on_platform(const Vector3& guess) const {
  const double xy = terms[1];
  const auto [xx, yy, zz, right] = make_normal_equations(*this, guess);
  const double determinant = xx * yy - xy * xy;
  return {(right[0] * yy - right[1] * xy) / determinant,
          (right[1] * xx - right[0] * xy) / determinant, 0.0};
}

Quadric plane_quadric(const Vector3& normal, double offset, double area) {
  const auto& [x, y, z] = normal;
  return {.terms = {area * (x * x), area * (x * y), area * (x * z), area * (y * y), area * (y * z),
                    area * (z * z), area * (x * offset), area * (y * offset), area * (z * offset),
                    area * (offset * offset)},
          .area = area};
}

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
