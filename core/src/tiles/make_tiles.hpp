#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>

#include "octurn/tiles.hpp"
#include "tiles/tile_file.hpp"

namespace octurn {

/// Takes a tile that is done.
using TileSink = std::function<void(const Tile& tile, const TileBricks& bricks)>;

/// Reconstructs tiles side by side, as many at once as the memory limit has room for. Of the
/// snapshots only those are read that one of these tiles takes.
///
/// @param tiles  of one plan, in its order
/// @param sink   called in that order
/// @throws Error "memory-limit", Stopped  and what the source and the sink throw
void make_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                const SnapshotSource& snapshots, const TileSink& sink,
                const std::stop_token& stop = {});

/// By voxel octree intersection: all tiles at once.
void make_leaf_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                     const SnapshotSource& snapshots, const TileSink& sink,
                     const std::stop_token& stop);

/// By the method `solid`: one tile. @param scan_snapshots  how many the whole scan has
void make_shell_tile(const ReconstructOptions& options, const Tile& tile,
                     std::size_t scan_snapshots, const SnapshotSource& snapshots,
                     const TileSink& sink, const std::stop_token& stop);

}  // namespace octurn
