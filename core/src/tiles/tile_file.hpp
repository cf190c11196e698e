#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "octurn/tiles.hpp"

namespace octurn {

/// A brick's position in its tile, from 0 to the tile's bricks along a side.
struct TileBrick {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint16_t z = 0;
};

/// What a reconstructed tile is made of: bricks of the method's kind.
struct TileBricks {
  std::vector<TileBrick> positions = {};  ///< sorted by z, then y, then x
  std::vector<std::byte> bricks = {};     ///< one after the other, `brick_bytes` each
};

/// The bytes of a brick in a tile: 8 x 8 x 8 leaves a bit each, or distances of voxels.
std::size_t brick_bytes(Method method);

/// What a tile tells of itself.
struct TileHeader {
  /// Those that tell what the bricks are; the others have their defaults.
  ReconstructOptions options = {};
  std::uint64_t plan = 0;  ///< checksum of the plan
  std::size_t tiles = 0;   ///< of the plan
  std::size_t number = 0;
  TileIndex index = {};
  std::size_t bricks = 0;
};

/// A tile as bytes: a line of text, a line of JSON, positions, bricks, and a checksum of it all.
/// @param write  called with its parts, in order
/// @return the offset of the positions
std::uint64_t write_tile_bytes(const TileHeader& header, const TileBricks& tile,
                               const std::function<void(std::span<const std::byte>)>& write);

/// A tile that was written, of which parts are read when they are asked for.
class StoredTile {
 public:
  /// Bytes from an offset in the tile. @throws Error  if they cannot be read
  using Read = std::function<void(std::uint64_t offset, std::span<std::byte> bytes)>;

  /// A tile of a file, whose checksum is checked.
  /// @throws Error "scan-malformed", "scan-missing", "read-failed"
  explicit StoredTile(const std::filesystem::path& file);

  /// A tile that this process wrote. @param first  the offset of its positions
  StoredTile(const TileHeader& header, Read read, std::uint64_t first);

  const TileHeader& header() const { return header_; }

  std::vector<TileBrick> positions() const;

  /// Bricks `first` to `first + count`, in the order of the positions.
  std::vector<std::byte> bricks(std::size_t first, std::size_t count) const;

 private:
  TileHeader header_ = {};
  Read read_ = {};
  std::uint64_t first_ = 0;
};

}  // namespace octurn
