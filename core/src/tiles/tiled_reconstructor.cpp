#include "tiles/tiled_reconstructor.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "tiles/make_tiles.hpp"
#include "tiles/plan_tiles.hpp"

namespace octurn {
namespace {

/// Returns the options. @throws Error "bad-settings"  if one is out of range
const ReconstructOptions& checked(const ReconstructOptions& options) {
  static_cast<void>(TileLattice(options));
  static_cast<void>(plan_threads(options));
  if (options.method == Method::solid &&
      !(options.target_error >= 0 && options.target_error < options.root_size)) {
    throw Error(ErrorCode::bad_settings, "max error: must be 0 or above");
  }
  if (options.edits.change_shape() || options.solid.max_triangles) {
    throw Error(ErrorCode::bad_settings, "the model of a space is not cut and has no set size",
                "Choose a smaller clip box, or a larger max error.");
  }
  if (options.method == Method::solid && options.level) {
    throw Error(ErrorCode::bad_settings, "level: the method solid has none");
  }
  return options;
}

TileHeader make_header(const ReconstructOptions& options, const TilePlan& plan, std::size_t number,
                       std::size_t bricks) {
  ReconstructOptions reported{.method = options.method,
                              .leaf_size = TileLattice(options).leaf_side(),
                              .root_size = options.root_size,
                              .clip = options.clip};
  if (options.method == Method::solid) {
    reported.target_error = options.target_error;
  } else {
    reported.threshold = options.threshold;
  }
  return {.options = reported,
          .plan = compute_checksum(plan),
          .tiles = plan.tiles.size(),
          .number = number,
          .index = plan.tiles[number].index,
          .bricks = bricks};
}

}  // namespace

TiledReconstructor::TiledReconstructor(const ReconstructOptions& options,
                                       std::filesystem::path spool)
    : options_(checked(options)),
      spool_folder_(spool.empty() ? std::filesystem::temp_directory_path() : std::move(spool)) {}

std::unique_ptr<Reconstructor> make_tiled_reconstructor(const ReconstructOptions& options,
                                                        const std::filesystem::path& spool) {
  return std::make_unique<TiledReconstructor>(options, spool);
}

/// Plans nothing yet: a plan needs all snapshots.
void TiledReconstructor::add(const Snapshot& /*snapshot*/, const std::stop_token& stop) {
  throw_if_stopped(stop);
  ++added_;
  plan_.reset();
  made_.clear();
}

void TiledReconstructor::add(const SnapshotSource& snapshots, const std::stop_token& stop) {
  const bool is_all = added_ == 0;
  added_ += snapshots.count;
  made_.clear();
  plan_ = is_all ? std::optional(plan_tiles(options_, snapshots, stop)) : std::nullopt;
}

void TiledReconstructor::make_tiles_once(const SnapshotSource& snapshots,
                                         const std::stop_token& stop) {
  if (!plan_) {
    plan_ = plan_tiles(options_, snapshots, stop);
  }
  if (!made_.empty()) {
    return;
  }
  spool_ = std::make_shared<UnnamedFile>(spool_folder_);
  std::vector<StoredTile> made;
  make_tiles(
      options_, plan_->tiles, snapshots,
      [&](const Tile& tile, const TileBricks& bricks) {
        if (options_.method == Method::solid) {
          expect_surface_room(options_, tile.index, bricks.positions);
        }
        const TileHeader header =
            make_header(options_, *plan_, made.size(), bricks.positions.size());
        const std::uint64_t begin = spool_->size();
        const std::uint64_t first = write_tile_bytes(
            header, bricks, [&](std::span<const std::byte> bytes) { spool_->append(bytes); });
        made.emplace_back(
            header,
            [spool = spool_](std::uint64_t offset, std::span<std::byte> bytes) {
              spool->read(offset, bytes);
            },
            begin + first);
      },
      stop);
  made_ = std::move(made);
}

SurfaceCount TiledReconstructor::surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                         const std::stop_token& stop) {
  make_tiles_once(snapshots, stop);
  return tile_surface(made_, sink, stop);
}

SurfaceCount TiledReconstructor::count(const SnapshotSource& snapshots,
                                       const std::stop_token& stop) {
  return surface(
      snapshots, [](std::span<const Facet>) {}, stop);
}

void TiledReconstructor::preview(double /*leaf_size*/, std::uint64_t /*max_facets*/,
                                 const FacetSink& /*sink*/, const std::stop_token& stop) const {
  throw_if_stopped(stop);
}

namespace {

/// The snapshots of a plan, whose checksums are verified when they are read.
SnapshotSource planned(const SnapshotSource& snapshots, const TilePlan& plan) {
  return {.count = snapshots.count, .read = [&snapshots, &plan](std::size_t index) {
            Snapshot snapshot = snapshots.read(index);
            if (compute_checksum(snapshot) != plan.snapshots[index]) {
              throw Error(
                  ErrorCode::scan_malformed,
                  "snapshot " + std::to_string(index) + " has changed since the plan was made",
                  "Make the plan again.");
            }
            return snapshot;
          }};
}

}  // namespace

void write_tile(const ReconstructOptions& options, const TilePlan& plan, std::size_t number,
                const SnapshotSource& snapshots, const std::filesystem::path& file,
                const std::stop_token& stop) {
  if (number >= plan.tiles.size()) {
    throw Error(
        ErrorCode::bad_settings,
        "tile " + std::to_string(number) + ": there are " + std::to_string(plan.tiles.size()),
        "octurn reconstruct --plan lists them; 0 is the first.");
  }
  if (plan.snapshots.size() != snapshots.count) {
    throw Error(ErrorCode::scan_malformed,
                "the plan was made for another scan: it has " +
                    std::to_string(plan.snapshots.size()) + " snapshots, and this scan has " +
                    std::to_string(snapshots.count),
                "Make the plan again.");
  }
  AtomicFile output(file);
  make_tiles(
      checked(options), std::span(plan.tiles).subspan(number, 1), planned(snapshots, plan),
      [&](const Tile& /*tile*/, const TileBricks& bricks) {
        write_tile_bytes(make_header(options, plan, number, bricks.positions.size()), bricks,
                         [&](std::span<const std::byte> bytes) { output.write(bytes); });
      },
      stop);
  output.commit();
}

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
