#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bennett/pseudo_voxels.hpp"
#include "octurn/stl.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// All layers of an octree.
inline BrickLayers all_layers(const Octree& octree) {
  return {.low = 0, .end = octree.brick_layers()};
}

/// Draws the surface between the octree's leaves and the empty space around them, and streams it.
///
/// The centres of eight adjacent leaves are the corners of a pseudo-voxel, each 1 where the leaf
/// is occupied and 0 where it is not (Bennett 2014). A pseudo-voxel is cut into six tetrahedra
/// about its main diagonal, the same way everywhere, and marching tetrahedra cut each edge in its
/// middle. The surface is closed and manifold by construction. Its vertices lie on multiples of
/// half a leaf, so they are bit-equal in neighbouring facets.
///
/// The order of facets depends on the leaves alone: layers of bricks from the bottom up, and in
/// each layer the bricks in Morton order. The surfaces of successive slabs, concatenated, are
/// therefore the surface of the whole, and the octree needs to hold only the slab and the lowest
/// leaves of the layer above it.
///
/// @param layers   the slab, layers of bricks
/// @param threads  number of threads that make facets
/// @param sink     called by one thread at a time; millimetres; an exception that it throws ends
/// the call
void marching_tetrahedra(const Octree& octree, const BrickLayers& layers, int threads,
                         const FacetSink& sink);

/// The position and scale of bricks, metres.
struct BrickFrame {
  double low_xy = 0;  ///< where brick 0 begins along x and along y; along z it begins at 0
  double leaf_side = 0;
};

/// Streams the surface of one layer of pseudo-voxels, row by row.
/// @param layer   of bricks
/// @param bricks  those that have leaves: of that layer, then of the layer above
void draw_layer(const BrickFrame& frame, int layer, std::vector<PlacedBrick> bricks,
                const FacetSink& sink);

/// Streams the surface of the finest level that has no more than `max_facets`.
void coarse_surface(Octree octree, std::uint64_t max_facets, const FacetSink& sink);

/// Counts the facets of `marching_tetrahedra` without making them.
std::uint64_t count_facets(const Octree& octree, const BrickLayers& layers);

/// A corner of a facet inside a pseudo-voxel, in halves of its side: 0, 1 or 2 on each axis.
using HalfSteps = std::array<std::int8_t, 3>;

struct CaseFacet {
  std::array<HalfSteps, 3> corners = {};
  std::array<float, 3> normal = {};  // of length one, outward
};

/// The facets of a pseudo-voxel by the pattern of its corners: bit x + 2y + 4z is set where the
/// corner (x, y, z) is inside.
struct TetrahedraCase {
  static constexpr std::size_t max_facets = 12;  // two in each of six tetrahedra
  std::array<CaseFacet, max_facets> facets = {};
  std::size_t count = 0;
  /// The volume inside, beyond n/4 of each tetrahedron with n of its corners inside, in eighths of
  /// a tetrahedron: tetrahedra cut in the middles of their edges hold 0, 1/8, 1/2, 7/8 and 1.
  int excess = 0;
};

/// Marching Tetrahedra for all 256 patterns, on the six tetrahedra that share the diagonal from
/// corner 0 to corner 7.
extern const std::array<TetrahedraCase, 256> marching_tetrahedra_cases;

}  // namespace octurn
