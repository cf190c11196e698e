#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>

#include "octurn/tiles.hpp"
#include "tiles/tile_file.hpp"

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

}  // namespace octurn
