#pragma once

#include <cstdint>

#include "octurn/stl.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// All layers of an octree.
inline BrickLayers all_layers(const Octree& octree) {
  return {.low = 0, .end = octree.brick_layers()};
}

/// The surface between the octree's leaves and the empty space around them.
///
/// The centres of eight adjacent leaves are the corners of a pseudo-voxel, each 1 where the leaf
/// exists and 0 where it does not (Bennett 2014). A pseudo-voxel is cut in six tetrahedra about its
/// main diagonal, the same way everywhere, and each tetrahedron by Marching Tetrahedra at half way.
/// The surface is closed and manifold by construction, and its vertices, functions of whole half
/// leaves, are bit-equal in neighbouring facets.
///
/// The order of the facets depends on the leaves alone: layers of bricks from below, in each the
/// bricks in Morton order. So the surfaces of successive ranges of layers, one after the other, are
/// the surface of them all, and an octree needs to hold no more than the layers of one range, and
/// the lowest leaves of the layer after it.
///
/// @param threads  that make facets; `sink` is called by one at a time, and what it throws ends all
void marching_tetrahedra(const Octree& octree, const BrickLayers& layers, int threads,
                         const FacetSink& sink);

/// The surface of the octree's leaves, or of the finest level above that has no more than
/// `max_facets`.
void coarse_surface(Octree octree, std::uint64_t max_facets, const FacetSink& sink);

/// The number of facets that `isosurface` gives, without making them.
std::uint64_t count_facets(const Octree& octree, const BrickLayers& layers);

}  // namespace octurn
