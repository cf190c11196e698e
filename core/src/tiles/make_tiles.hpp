#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>

#include "octurn/tiles.hpp"
#include "tiles/tile_files.hpp"

namespace octurn {

/// Receives a finished tile.
using TileSink = std::function<void(const Tile& tile, const TileBricks& bricks)>;

/// Reconstructs tiles, as many at once as fit in the memory limit. Reads only the snapshots that
/// one of these tiles uses.
///
/// @param tiles  of one plan, in its order
/// @param sink   called in that order
/// @throws Error "memory-limit", Stopped  and what the source and the sink throw
void make_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                const SnapshotSource& snapshots, const TileSink& sink,
                const std::stop_token& stop = {});

/// Makes all tiles at once, by voxel octree intersection.
void make_leaf_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                     const SnapshotSource& snapshots, const TileSink& sink,
                     const std::stop_token& stop);

/// Makes one tile, by the method `solid`. @param scan_snapshots  number of the whole scan's
void make_shell_tile(const ReconstructOptions& options, const Tile& tile,
                     std::size_t scan_snapshots, const SnapshotSource& snapshots,
                     const TileSink& sink, const std::stop_token& stop);

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
