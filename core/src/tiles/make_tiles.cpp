#include "tiles/make_tiles.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "tiles/plan_tiles.hpp"

namespace octurn {
namespace {

/// The snapshots of a source that the tiles use.
SnapshotSource only_used(const SnapshotSource& snapshots, std::span<const Tile> tiles) {
  std::set<std::size_t> taken;
  for (const Tile& tile : tiles) {
    taken.insert(tile.snapshots.begin(), tile.snapshots.end());
  }
  return {.count = taken.size(),
          .read = [read = snapshots.read,
                   numbers = std::vector<std::size_t>(taken.begin(), taken.end())](std::size_t i) {
            return read(numbers[i]);
          }};
}

/// The longest prefix of the tiles that fits in memory at once. Sets the number of threads.
std::span<const Tile> first_group(ReconstructOptions& options, std::span<const Tile> tiles) {
  const Tile& largest = *std::ranges::max_element(tiles, {}, &Tile::bytes);
  const TileRoom room = room_for(options, largest);
  options.threads = room.threads;
  if (options.method == Method::solid) {
    return tiles.first(1);  // its threads share a tile
  }
  std::size_t count = 0;
  for (std::size_t taken = 0; count < tiles.size(); ++count) {
    taken += tiles[count].bytes;
    if (taken > room.bytes) {
      break;
    }
  }
  return tiles.first(std::max<std::size_t>(count, 1));
}

}  // namespace

void make_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                const SnapshotSource& snapshots, const TileSink& sink,
                const std::stop_token& stop) {
  while (!tiles.empty()) {
    ReconstructOptions within = options;
    const std::span<const Tile> group = first_group(within, tiles);
    const SnapshotSource part = only_used(snapshots, group);
    if (options.method == Method::solid) {
      make_shell_tile(within, group.front(), snapshots.count, part, sink, stop);
    } else {
      make_leaf_tiles(within, group, part, sink, stop);
    }
    tiles = tiles.subspan(group.size());
  }
}

}  // namespace octurn
