#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/vector3.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Area-weighted sum of squared distances to planes (Garland and Heckbert 1997, sections 4 and 5):
/// Q(p) = p^T A p + 2 b^T p + c, in mm^2 * mm^2.
///
/// Written out rather than by Eigen's matrices: the packed symmetric A saves a quarter of the
/// memory, and a fixed order of operations keeps models bit-equal on every processor.
struct Quadric {
  std::array<double, 10> terms = {};  ///< A: xx, xy, xz, yy, yz, zz; b: x, y, z; c
  double area = 0;                    ///< total weight, mm^2; a plane counts each time it is added

  void operator+=(const Quadric& other) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      terms[i] += other.terms[i];
    }
    area += other.area;
  }

  /// Mean of the squared distances from `p` to the planes, weighted by area: its root is an RMS
  /// distance. Square millimetres; not a number if the total area is 0.
  double mean_square(const Vector3& p) const {
    const auto& [xx, xy, xz, yy, yz, zz, x, y, z, c] = terms;
    const double sum = p[0] * (xx * p[0] + 2 * (xy * p[1] + xz * p[2] + x)) +
                       p[1] * (yy * p[1] + 2 * (yz * p[2] + y)) + p[2] * (zz * p[2] + 2 * z) + c;
    return std::max(sum / area, 0.0);  // rounding can bring it below
  }

  /// The point of the smallest sum. In directions that the planes do not determine it stays near
  /// `guess`.
  Vector3 optimum(const Vector3& guess) const;

  /// The same among the points of the platform, z = 0.
  Vector3 optimum_on_platform(const Vector3& guess) const;
};

/// Quadric of one plane, n^T p + offset = 0.
///
/// @param normal  of length 1
/// @param area    weight
Quadric plane_quadric(const Vector3& normal, double offset, double area);

/// A triangle mesh with shared vertices, and for each the quadric of the original surface, which
/// edge collapse needs.
struct IndexedMesh {
  std::vector<MeshVertex> vertices = {};
  std::vector<Quadric> quadrics = {};  ///< one per vertex; apart, so that positions stay in cache
  std::vector<MeshTriangle> triangles = {};
};

/// Adds to each vertex's quadric the planes of its triangles, from the triangle `first` on, in
/// their order. The last vertices may be without a quadric yet.
void add_plane_quadrics(IndexedMesh& mesh, std::size_t first,
                        ThreadTeam& team = ThreadTeam::alone());

constexpr std::uint32_t removed_vertex = std::numeric_limits<std::uint32_t>::max();

/// Removes the vertices that neither a triangle nor `also_used` refers to; the others keep their
/// order. O(vertices + triangles).
///
/// @returns for each old vertex its new index, or `removed_vertex`
std::vector<std::uint32_t> compact(IndexedMesh& mesh, std::span<const std::uint32_t> also_used);

}  // namespace octurn
