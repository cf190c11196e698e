#pragma once

#include <cstdint>

#include "octurn/json_object.hpp"
#include "octurn/tiles.hpp"

namespace octurn {

/// The checksum of a depth image, its intrinsics and its pose.
std::uint64_t compute_checksum(const Snapshot& snapshot);

/// The checksum of the tiles' indices and of all snapshots.
std::uint64_t compute_checksum(const TilePlan& plan);

/// Reads a tile's index, an array of three integers. @throws Error  if the value is no index
TileIndex tile_index_from(const JsonValue& value);

/// Reads a checksum, a string of decimal digits. @throws Error  if the value is no checksum
std::uint64_t checksum_from(const JsonValue& value);

}  // namespace octurn
