#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "octurn/stl.hpp"

namespace octurn {

struct MeshVertex {
  std::array<float, 3> position = {};  ///< millimetres
  bool observed = false;               ///< measured; otherwise filled in
  bool fixed = false;                  ///< shared with a neighbouring mesh: must not move
};

/// The facet of a triangle with its unit normal, which is 0 if the triangle has no area.
/// `filled_in` if at most one corner was observed.
Facet to_facet(const std::array<MeshVertex, 3>& corners);

/// Indices of a triangle's vertices, counter-clockwise seen from outside.
using MeshTriangle = std::array<std::uint32_t, 3>;

/// A part of a streamed mesh. Vertices are numbered consecutively through the whole mesh; triangles
/// refer to vertices of this piece and of the one before.
struct MeshPiece {
  std::span<const MeshVertex> vertices = {};
  std::span<const MeshTriangle> triangles = {};
};

/// Receives a mesh piece by piece, in order. The spans are valid only during the call.
using MeshSink = std::function<void(const MeshPiece&)>;

}  // namespace octurn
