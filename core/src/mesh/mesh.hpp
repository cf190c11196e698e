#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "octurn/stl.hpp"

namespace octurn {

struct MeshVertex {
  std::array<float, 3> position = {};  // millimetres
  bool seen = false;                   // or filled in
};

/// A triangle as a facet: `filled_in` where most of its corners were not seen.
Facet to_facet(const std::array<MeshVertex, 3>& corners);

/// Corners of a triangle, counter-clockwise seen from outside, as numbers of vertices.
using MeshTriangle = std::array<std::uint32_t, 3>;

/// Some of a mesh: the vertices that come next, numbered on through the whole mesh, and triangles
/// of these and the ones before.
struct MeshPiece {
  std::span<const MeshVertex> vertices = {};
  std::span<const MeshTriangle> triangles = {};
};

/// Takes a mesh piece by piece, in order. A piece's triangles have no vertices but its own and
/// those of the piece before it.
using MeshSink = std::function<void(const MeshPiece&)>;

}  // namespace octurn
