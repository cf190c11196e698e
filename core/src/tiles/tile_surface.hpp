#pragma once

#include <span>
#include <stop_token>

#include "octurn/tiles.hpp"
#include "tiles/tile_file.hpp"

namespace octurn {

/// Streams the closed surface of all tiles of a plan.
///
/// By voxel octree intersection the facets are those of one octree around all tiles, in layers of
/// bricks from the bottom up, and row by row in a layer. Their order does not depend on the tiles'
/// side. The bricks of two layers are in memory.
///
/// By the method `solid` the facets come tile by tile. One tile and the adjacent bricks of its
/// neighbours are in memory. A tile is drawn column by column, as the simplifier holds a whole
/// layer, which a floor fills.
///
/// @param tiles  all of one plan, in its order
/// @throws Error "scan-malformed", "read-failed", Stopped  and what the sink throws
SurfaceCount tile_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop = {});

/// Voxels along x and y of a column of a tile that `shell_surface` draws and simplifies by itself.
inline constexpr int shell_column_side = 128;

/// Streams the surface of tiles by voxel octree intersection.
SurfaceCount leaf_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop);

/// Streams the surface of tiles by the method `solid`.
SurfaceCount shell_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                           const std::stop_token& stop);

}  // namespace octurn
