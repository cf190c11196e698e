#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "octurn/error.hpp"
#include "tiles/tile_file.hpp"
#include "tiles/tile_surface.hpp"

namespace octurn {
namespace {

/// Names what two tiles differ in; empty if they belong to one plan.
std::string difference(const TileHeader& a, const TileHeader& b) {
  const ReconstructOptions& x = a.options;
  const ReconstructOptions& y = b.options;
  if (x.method != y.method) {
    return "method";
  }
  if (x.root_size != y.root_size) {
    return "root size";
  }
  if (x.leaf_size != y.leaf_size) {
    return "leaf size";
  }
  if (x.threshold != y.threshold) {
    return "threshold";
  }
  if (x.target_error != y.target_error) {
    return "max error";
  }
  if (x.clip.min != y.clip.min || x.clip.max != y.clip.max) {
    return "clip box";
  }
  return a.plan != b.plan || a.tiles != b.tiles ? "plan" : "";
}

/// Reads all tiles of a plan, sorted by number.
/// @throws Error  if one is missing, is there twice, or belongs to another plan
std::vector<StoredTile> read_tiles(std::span<const std::filesystem::path> files) {
  std::vector<std::optional<StoredTile>> by_number;
  std::vector<const std::filesystem::path*> file_of;
  std::optional<TileHeader> first;
  for (const std::filesystem::path& file : files) {
    StoredTile tile(file);
    if (!first) {
      first = tile.header();
      by_number.resize(first->tiles);
      file_of.resize(first->tiles);
    }
    if (const std::string what = difference(*first, tile.header()); !what.empty()) {
      throw Error(
          ErrorCode::scan_malformed,
          file.string() + ": its " + what + " differs from that of " + files.front().string(),
          "Join the tiles of one plan.");
    }
    const std::size_t number = tile.header().number;
    if (by_number[number]) {
      throw Error(ErrorCode::scan_malformed,
                  file.string() + ": is tile " + std::to_string(number) + ", as " +
                      file_of[number]->string() + " is",
                  "Name each tile once.");
    }
    by_number[number] = std::move(tile);
    file_of[number] = &file;
  }
  std::vector<StoredTile> tiles;
  for (std::size_t number = 0; number < by_number.size(); ++number) {
    if (!by_number[number]) {
      throw Error(ErrorCode::scan_missing,
                  "tile " + std::to_string(number) + " of " + std::to_string(by_number.size()) +
                      " is missing",
                  "Make it by octurn reconstruct --tile " + std::to_string(number) + ".");
    }
    tiles.push_back(std::move(*by_number[number]));
  }
  if (!std::ranges::is_sorted(tiles, [](const StoredTile& a, const StoredTile& b) {
        return a.header().index < b.header().index;
      })) {
    throw Error(ErrorCode::scan_malformed, "the tiles' numbers are not those of one plan");
  }
  return tiles;
}

}  // namespace

SurfaceCount tile_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop) {
  if (tiles.empty()) {
    return {};
  }
  return tiles.front().header().options.method == Method::solid ? shell_surface(tiles, sink, stop)
                                                                : leaf_surface(tiles, sink, stop);
}

SurfaceCount join_tiles(std::span<const std::filesystem::path> files, const FacetSink& sink,
                        const std::stop_token& stop) {
  return tile_surface(read_tiles(files), sink, stop);
}

}  // namespace octurn
