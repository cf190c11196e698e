#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/tiles.hpp"

namespace octurn {

/// A brick's position in its tile, in bricks from the tile's lowest corner.
struct TileBrick {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint16_t z = 0;
};

/// The bricks of a reconstructed tile: `Brick` for intersection, `ShellBrick` for `solid`.
struct TileBricks {
  std::vector<TileBrick> positions = {};  ///< sorted by z, then y, then x
  std::vector<std::byte> bricks = {};     ///< one after the other, `brick_bytes` each
};

/// The size of a stored brick, bytes: one bit for each of 8 x 8 x 8 leaves, or distances of voxels.
std::size_t brick_bytes(Method method);

/// The metadata of a stored tile.
struct TileHeader {
  /// Only the options on which the bricks depend; the others have their defaults.
  ReconstructOptions options = {};
  std::uint64_t plan = 0;  ///< checksum of the plan
  std::size_t tiles = 0;   ///< of the plan
  std::size_t number = 0;
  TileIndex index = {};
  std::size_t bricks = 0;
};

/// Serialises a tile: a line of text, a line of JSON, positions, bricks, and a checksum of these.
/// @param write  called with the parts in order
/// @return the offset of the positions
std::uint64_t write_tile_bytes(const TileHeader& header, const TileBricks& tile,
                               const std::function<void(std::span<const std::byte>)>& write);

/// A stored tile, whose positions and bricks are read on demand.
class StoredTile {
 public:
  /// Reads bytes from an offset in the file. @throws Error  if they cannot be read
  using Read = std::function<void(std::uint64_t offset, std::span<std::byte> bytes)>;

  /// Opens a tile file, and verifies its checksum.
  /// @throws Error "scan-malformed", "scan-missing", "read-failed"
  explicit StoredTile(const std::filesystem::path& file);

  /// A tile that this process wrote. @param first  offset of its positions in the file
  StoredTile(const TileHeader& header, Read read, std::uint64_t first);

  const TileHeader& header() const { return header_; }

  /// The positions of all bricks.
  /// @throws Error "scan-malformed"  if they are not sorted, or one lies outside the tile
  std::vector<TileBrick> positions() const;

  /// Bricks `first` to `first + count`, in the order of the positions.
  std::vector<std::byte> bricks(std::size_t first, std::size_t count) const;

 private:
  TileHeader header_ = {};
  Read read_ = {};
  std::uint64_t first_ = 0;
};

/// The checksum of a depth image, its intrinsics and its pose.
std::uint64_t compute_checksum(const Snapshot& snapshot);

/// The checksum of the tiles' indices and of all snapshots.
std::uint64_t compute_checksum(const TilePlan& plan);

/// Reads a tile's index, an array of three integers. @throws Error  if the value is no index
TileIndex tile_index_from(const JsonValue& value);

/// Reads a checksum, a string of decimal digits. @throws Error  if the value is no checksum
std::uint64_t checksum_from(const JsonValue& value);

/// Detects accidental changes of bytes, but not forgery: FNV-1a (Fowler, Noll and Vo 1991), 64
/// bits.
class Checksum {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      value_ = (value_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3U;
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace octurn
