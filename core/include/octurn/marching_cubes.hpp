#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "octurn/facet.hpp"
#include "octurn/filled_field.hpp"
#include "octurn/leaf_set.hpp"

namespace octurn {

struct MeshVertex {
  std::array<float, 3> position = {};  // millimetres
  bool seen = false;                   // or filled in
};

/// A triangle as a facet: `filled_in` where most of its corners were not seen.
Facet facet_of(const std::array<MeshVertex, 3>& corners);

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

/// The surface between the leaves of a set and those around it, with its vertices where the field
/// crosses zero; a layer of leaves at a time.
///
/// Closed and manifold whatever the signs are (see `cube_surfaces`), without cuts through itself,
/// and with no two vertices closer than slicers meld. Leaves on the sides of the set's box must be
/// empty, but for its lowest layer.
void marching_cubes(const LeafSet& inside, const FilledField& field, const MeshSink& sink);

}  // namespace octurn
