#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octurn {

/// An edge of a cube: axis * 4 + where it begins on the two axes that follow (0 or 1, and 2 times 0
/// or 1).
using CubeEdge = std::uint8_t;

/// The triangles of a cube by the pattern of its corners: bit x + 2y + 4z is set where the corner
/// (x, y, z) is inside.
struct CubeSurface {
  static constexpr std::size_t max_triangles = 5;
  std::array<std::array<CubeEdge, 3>, max_triangles> triangles = {};
  std::size_t count = 0;
};

/// Marching Cubes (Lorensen and Cline 1987) for all 256 patterns, made from a rule for the signs on
/// a face: two inside corners across its diagonal are apart. So cubes agree on the faces they
/// share, and as no triangle has a side across a face that is not on the face's own lines, the
/// surface is closed and manifold whatever the signs.
extern const std::array<CubeSurface, 256> marching_cubes_cases;

/// Whether the triangles of a pattern can cut each other, where its crossings lie near corners.
/// From 0.3 to 0.7 of an edge they never do.
bool is_self_intersecting_case(std::size_t pattern);

}  // namespace octurn
