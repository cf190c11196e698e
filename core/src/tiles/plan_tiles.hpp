#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octurn/tiles.hpp"
#include "tiles/tile_files.hpp"

namespace octurn {

// The memory of tiles, for the memory limit.

/// The memory of a tile with this number of occupied bricks, bytes.
std::size_t tile_bytes(const ReconstructOptions& options, std::uint64_t bricks);

/// The number of threads that fit in the memory limit while tiles are planned.
/// @throws Error "memory-limit"  if not one fits
int plan_threads(const ReconstructOptions& options);

/// The number of threads that fit in the memory limit while tiles are made, and the bytes left for
/// tiles.
struct TileRoom {
  int threads = 1;
  std::size_t bytes = 0;
};

/// @param tile  the largest one
/// @throws Error "memory-limit"  if it does not fit with one thread
TileRoom room_for(const ReconstructOptions& options, const Tile& tile);

/// @throws Error "memory-limit"  if the limit has no room for the surface of a tile
void expect_surface_room(const ReconstructOptions& options, const TileIndex& tile,
                         std::span<const TileBrick> bricks);

}  // namespace octurn
