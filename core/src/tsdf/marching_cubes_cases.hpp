#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "voxel/index3.hpp"

namespace octurn {

/// An edge of a cube: axis * 4 + where it begins on the two axes that follow (0 or 1, and 2 times 0
/// or 1).
using CubeEdge = std::uint8_t;

/// The axis, 0 to 2, that an edge lies along.
constexpr std::size_t edge_axis(CubeEdge edge) { return edge / 4U; }

/// The corner at which an edge begins, given the cube's lowest corner.
constexpr Index3 find_start(CubeEdge edge, const Index3& cube) {
  const int u = edge % 2;
  const int v = edge / 2 % 2;
  switch (edge_axis(edge)) {
    case 0:
      return {cube.x, cube.y + u, cube.z + v};
    case 1:
      return {cube.x + v, cube.y, cube.z + u};
    default:
      return {cube.x + u, cube.y + v, cube.z};
  }
}

/// The corner x + 2y + 4z of a cube.
constexpr Index3 cube_corner(const Index3& cube, std::size_t corner) {
  const auto bit = [&](unsigned axis) { return static_cast<int>(corner >> axis & 1); };
  return {cube.x + bit(0), cube.y + bit(1), cube.z + bit(2)};
}

/// The triangles of a cube by the pattern of its corners: bit x + 2y + 4z is set where the corner
/// (x, y, z) is inside.
struct CubeSurface {
  static constexpr std::size_t max_triangles = 5;
  std::array<std::array<CubeEdge, 3>, max_triangles> triangles = {};
  std::size_t count = 0;
};

/// Marching Cubes (Lorensen and Cline 1987) for all 256 patterns, made from a rule for the signs on
/// a face: two inside corners on its diagonal are not connected. Neighbouring cubes therefore agree
/// on the face that they share. No other triangle side lies in a face, so the surface is closed and
/// manifold for all signs.
extern const std::array<CubeSurface, 256> marching_cubes_cases;

/// Whether the triangles of a pattern can cut each other, where its crossings lie near corners.
/// From 0.3 to 0.7 of an edge they never do.
bool is_self_intersecting_case(std::size_t pattern);

}  // namespace octurn
