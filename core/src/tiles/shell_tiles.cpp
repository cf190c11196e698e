#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "depth/condition_depth.hpp"
#include "depth/crop.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/units.hpp"
#include "tiles/make_tiles.hpp"
#include "tiles/tile_lattice.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/facet_stream.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/marching_cubes.hpp"
#include "tsdf/shell.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {
namespace {

// With fewer snapshots one ray is enough to mark free space, as hardly another one can confirm it.
constexpr std::size_t few_snapshots = 4;

Box moved(const Box& box, const Eigen::Vector3d& by) {
  return {.min = box.min + by, .max = box.max + by};
}

/// The conditioned snapshots in the frame of a tile, in which the tile is the root cube.
ConditionedSource conditioned(const SnapshotSource& snapshots, const Box& clip,
                              const Eigen::Vector3d& origin, const VoxelGrid& grid) {
  return {.count = snapshots.count, .make = [=, &snapshots](std::size_t index) {
            Snapshot snapshot = snapshots.read(index);
            snapshot.object_from_sensor.pretranslate(-origin);
            std::vector<ConditionedDepth> depth;
            depth.emplace_back(crop(snapshot, grid.box()), moved(clip, -origin),
                               shell_reference_depth);
            return depth;
          }};
}

/// The tile's own bricks of a TSDF: all but the border.
TileBricks own_bricks(const CompactTsdf& tsdf) {
  TileBricks tile;
  const Index3& size = tsdf.grid().size();
  for (int z = 1; z < size.z - 1; ++z) {
    for (int y = 1; y < size.y - 1; ++y) {
      for (int x = 1; x < size.x - 1; ++x) {
        ShellBrick shell;
        const CompactBrick* const brick = tsdf.find({x, y, z});
        if (brick == nullptr || !make_shell(*brick, shell)) {
          continue;
        }
        tile.positions.push_back({.x = static_cast<std::uint16_t>(x - 1),
                                  .y = static_cast<std::uint16_t>(y - 1),
                                  .z = static_cast<std::uint16_t>(z - 1)});
        const std::size_t end = tile.bricks.size();
        tile.bricks.resize(end + sizeof shell);
        std::memcpy(&tile.bricks[end], &shell, sizeof shell);
      }
    }
  }
  return tile;
}

}  // namespace

void make_shell_tile(const ReconstructOptions& options, const Tile& tile,
                     std::size_t scan_snapshots, const SnapshotSource& snapshots,
                     const TileSink& sink, const std::stop_token& stop) {
  const VoxelGrid grid = make_shell_grid(options);
  const ConditionedSource source =
      conditioned(snapshots, options.clip, TileLattice(options).origin(tile.index), grid);
  CompactTsdf tsdf(grid, scan_snapshots < few_snapshots ? votes_of_any_ray : votes_of_surface_ray);
  {  // Frees the volume before the tile's bricks are made.
    // The plan's bound fits in the memory limit. A volume without a limit can be shared by threads.
    TsdfVolume volume(grid);
    integrate(volume, source, options.threads, stop);
    tsdf.add(volume, stop);
  }
  sink(tile, own_bricks(tsdf));
}

namespace {

constexpr double margin_voxels = 8;  // kept below the upper end of the simplifier's window
constexpr std::size_t run = 256;     // bricks that are read at once

using TilesByIndex = std::map<TileIndex, const StoredTile*>;

/// The bricks of a tile, and the bricks of its neighbours that touch it.
class TileField {
 public:
  TileField(const TileLattice& lattice, const TileIndex& tile)
      : tile_(tile),
        bricks_per_side_(lattice.bricks_per_side()),
        field_(lattice.root_side(), lattice.leaf_side(),
               {tile.x * bricks_per_side_ - 1, tile.y * bricks_per_side_ - 1,
                tile.z * bricks_per_side_ - 1},
               {bricks_per_side_ + 2, bricks_per_side_ + 2, bricks_per_side_ + 2}) {}

  const ShellField& field() const { return field_; }

  void add(const StoredTile& from) {
    const std::vector<TileBrick> positions = from.positions();
    for (std::size_t first = 0; first < positions.size();) {
      std::size_t end = first;
      while (end < positions.size() && end - first < run && is_near(positions[end], from)) {
        ++end;
      }
      add_run(from, positions, first, end);
      first = std::max(end, first + 1);
    }
  }

 private:
  Index3 placed(const TileBrick& at, const TileIndex& tile) const {
    return {tile.x * bricks_per_side_ + at.x, tile.y * bricks_per_side_ + at.y,
            tile.z * bricks_per_side_ + at.z};
  }

  bool is_near(const TileBrick& brick, const StoredTile& from) const {
    const Index3 at = placed(brick, from.header().index);
    const auto near = [&](int value, int tile) {
      return value >= tile * bricks_per_side_ - 1 && value <= (tile + 1) * bricks_per_side_;
    };
    return near(at.x, tile_.x) && near(at.y, tile_.y) && near(at.z, tile_.z);
  }

  void add_run(const StoredTile& from, const std::vector<TileBrick>& positions, std::size_t first,
               std::size_t end) {
    const std::vector<std::byte> bytes = from.bricks(first, end - first);
    for (std::size_t i = first; i < end; ++i) {
      ShellBrick brick;
      std::memcpy(&brick, &bytes[(i - first) * sizeof brick], sizeof brick);
      field_.add(placed(positions[i], from.header().index), brick);
    }
  }

  TileIndex tile_;
  int bricks_per_side_;
  ShellField field_;
};

/// Reads the field of a tile: its own bricks, and those around it.
TileField make_field(const TileLattice& lattice, const TilesByIndex& tiles, const TileIndex& tile) {
  TileField field(lattice, tile);
  for (int z = tile.z - 1; z <= tile.z + 1; ++z) {
    for (int y = tile.y - 1; y <= tile.y + 1; ++y) {
      for (int x = tile.x - 1; x <= tile.x + 1; ++x) {
        if (const auto found = tiles.find({.x = x, .y = y, .z = z}); found != tiles.end()) {
          field.add(*found->second);
        }
      }
    }
  }
  return field;
}

/// The number of a mask's voxels within a range of cubes: a cube belongs to the voxel at its lowest
/// corner.
std::uint64_t count_voxels(const VoxelMask& mask, const CubeRange& range) {
  std::uint64_t count = 0;
  for (int z = range.low.z; z < range.end.z; ++z) {
    for (int y = range.low.y; y < range.end.y; ++y) {
      for (const std::uint64_t word : mask.row(y, z)) {
        count += static_cast<std::uint64_t>(std::popcount(word));
      }
      for (int x = 0; x < mask.size().x; ++x) {
        if (x == range.low.x) {
          x = range.end.x;
        }
        count -= mask.contains(x, y, z) ? 1 : 0;
      }
    }
  }
  return count;
}

/// The tiles, and their neighbours towards -X, -Y and -Z: a cube lies in the tile of its lowest
/// corner, so that surfaces may end in an empty tile.
std::set<TileIndex> drawn_tiles(const TilesByIndex& tiles) {
  std::set<TileIndex> drawn;
  for (const auto& [index, tile] : tiles) {
    for (int corner = 0; corner < 8; ++corner) {
      drawn.insert({.x = index.x - (corner & 1),
                    .y = index.y - (corner >> 1 & 1),
                    .z = index.z - (corner >> 2)});
    }
  }
  return drawn;
}

/// Draws the cubes of a column, and simplifies their mesh, which is open towards the columns beside
/// it.
void draw_column(const VoxelMask& inside, const ShellField& field, const CubeRange& cubes,
                 double target_error, const FacetSink& sink, const std::stop_token& stop) {
  if (target_error > 0) {
    StreamSimplifier simplifier(mm_from_metres(target_error),
                                mm_from_metres(margin_voxels * field.voxel_side()), sink, stop);
    marching_cubes(
        inside, field, cubes, [&](const MeshPiece& piece) { simplifier.add(piece); }, stop);
    simplifier.finish();
  } else {
    FacetStream facets(sink);
    marching_cubes(
        inside, field, cubes, [&](const MeshPiece& piece) { facets.add(piece); }, stop);
  }
}

}  // namespace

SurfaceCount shell_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                           const std::stop_token& stop) {
  const ReconstructOptions& options = tiles.front().header().options;
  const TileLattice lattice(options);
  TilesByIndex by_index;
  for (const StoredTile& tile : tiles) {
    by_index[tile.header().index] = &tile;
  }
  const int side = lattice.leaves_per_side();
  const int width = std::min(side, shell_column_side);
  // A vertex depends on the cubes around its own: one more voxel is needed below, two above.
  const CubeRange cubes{.low = {1, 1, 1}, .end = {width + 1, width + 1, side + 1}};
  SurfaceCount count;
  const auto draw = [&](const ShellField& field, const Index3& low) {
    throw_if_stopped(stop);
    const VoxelMask inside =
        field.inside(low, {low.x + width + 3, low.y + width + 3, low.z + side + 3});
    if (inside.count() == 0) {
      return;
    }
    count.leaves += count_voxels(inside, cubes);
    draw_column(
        inside, field, cubes, options.target_error,
        [&](std::span<const Facet> facets) {
          throw_if_stopped(stop);
          count.facets += facets.size();
          sink(facets);
        },
        stop);
  };
  for (const TileIndex& index : drawn_tiles(by_index)) {
    const TileField near = make_field(lattice, by_index, index);
    for (int y = 0; y < side; y += width) {
      for (int x = 0; x < side; x += width) {
        draw(near.field(), {index.x * side + x - 1, index.y * side + y - 1, index.z * side - 1});
      }
    }
  }
  return count;
}

}  // namespace octurn
