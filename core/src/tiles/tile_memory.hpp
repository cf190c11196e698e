#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octurn/tiles.hpp"
#include "tiles/tile_file.hpp"

namespace octurn {

/// What tiles take of the memory limit.

/// Bytes of a tile in which something is in so many bricks.
std::size_t tile_bytes(const ReconstructOptions& options, std::uint64_t bricks);

/// Threads for which the limit leaves room, while tiles are found.
/// @throws Error "memory-limit"  if there is none
int plan_threads(const ReconstructOptions& options);

/// The same, and the bytes that are left for tiles, while they are made.
struct TileRoom {
  int threads = 1;
  std::size_t bytes = 0;
};

/// @param tile  that must fit. @throws Error "memory-limit"
TileRoom room_for(const ReconstructOptions& options, const Tile& tile);

/// Bytes that drawing and simplifying the surface of a tile takes, by the method `solid`.
/// @param bricks  of the tile, as in `TileBricks`
std::size_t shell_surface_bytes(const ReconstructOptions& options,
                                std::span<const TileBrick> bricks);

/// @throws Error "memory-limit"  if the limit has no room for the surface of a tile
void expect_surface_room(const ReconstructOptions& options, const TileIndex& tile,
                         std::span<const TileBrick> bricks);

}  // namespace octurn
