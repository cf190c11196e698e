#pragma once

#include <cstdint>

#include "octurn/json_object.hpp"
#include "octurn/tiles.hpp"

namespace octurn {

/// Of a depth image, its camera and its pose.
std::uint64_t checksum_of(const Snapshot& snapshot);

/// Of the tiles and of all snapshots.
std::uint64_t checksum_of(const TilePlan& plan);

/// A tile's index as three numbers in a file. @throws Error  of the value, if it is none
TileIndex tile_index_from(const JsonValue& value);

/// A checksum as its digits in a file. @throws Error  of the value, if it is none
std::uint64_t checksum_from(const JsonValue& value);

}  // namespace octurn
