#include <cstring>
#include <vector>

#include "depth/condition_depth.hpp"
#include "depth/crop.hpp"
#include "tiles/make_tiles.hpp"
#include "tiles/tile_lattice.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/integrate_scan.hpp"
#include "tsdf/integration_model.hpp"
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

}  // namespace octurn
