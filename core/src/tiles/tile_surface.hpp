#pragma once

#include <span>
#include <stop_token>

#include "octurn/tiles.hpp"
#include "tiles/tile_file.hpp"

namespace octurn {

/// Streams the closed surface of all tiles of a plan.
///
/// By voxel octree intersection the facets are those of one octree around all tiles, layer by layer
/// of bricks from the bottom up, in each row by row: their order does not depend on the tiles'
/// side. In memory are the bricks of two layers. By the method `solid` they come tile by tile, and
/// in memory are one tile and the sides of those around it. A tile is drawn column by column, as
/// the simplifier holds a layer at once, and a floor fills one.
///
/// @param tiles  all of one plan, in its order
/// @throws Error "scan-malformed", "read-failed", Stopped  and what the sink throws
SurfaceCount tile_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop = {});

/// Voxels along x and y of a column of a tile that `shell_surface` draws and simplifies by itself.
inline constexpr int shell_column_side = 128;

/// By voxel octree intersection.
SurfaceCount leaf_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop);

/// By the method `solid`.
SurfaceCount shell_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                           const std::stop_token& stop);

}  // namespace octurn
