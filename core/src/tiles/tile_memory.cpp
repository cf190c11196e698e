#include "tiles/tile_memory.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string>

#include "io/number_text.hpp"
#include "octurn/error.hpp"
#include "tiles/tile_surface.hpp"
#include "tsdf/shell.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/block_pool.hpp"
#include "voxel/memory_limit.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

// Memory of each thread, measured with frames of 640 x 480 samples: its snapshot, points and
// results; for `solid` its conditioned depth, too.
constexpr std::size_t points_bytes = 8 * mebibyte;
constexpr std::size_t conditioned_bytes = 17 * mebibyte;

// The simplifier's window takes 170 bytes a triangle. It holds two layers of a column, in which a
// brick of a floor has two sides of 128 triangles each, or its usual 30,000 triangles.
constexpr std::size_t layer_brick_bytes = 2 * 256 * std::size_t{170};
constexpr std::size_t window_bytes = 5 * mebibyte;

std::size_t thread_bytes(const ReconstructOptions& options) {
  return options.method == Method::solid ? conditioned_bytes : points_bytes;
}

template <typename Item>
std::size_t pool_bytes(std::uint64_t items) {
  return (static_cast<std::size_t>(items) / BlockPool<Item>::block_items + 1) *
         BlockPool<Item>::block_bytes;
}

/// @param needed  bytes that would be enough
[[noreturn]] void refuse(const ReconstructOptions& options, const TileIndex& tile,
                         std::size_t needed) {
  throw Error(ErrorCode::memory_limit,
              "memory limit: tile (" + std::to_string(tile.x) + ", " + std::to_string(tile.y) +
                  ", " + std::to_string(tile.z) + ") does not fit in " +
                  mb_text(options.memory_limit),
              "Allow " + mb_text(needed) + ", or choose a smaller root size or a larger leaf size.",
              {{"tile_x", static_cast<double>(tile.x)},
               {"tile_y", static_cast<double>(tile.y)},
               {"tile_z", static_cast<double>(tile.z)},
               {"limit_mb", rounded_up_mb(options.memory_limit)},
               {"needed_mb", rounded_up_mb(needed)}});
}

}  // namespace

std::size_t tile_bytes(const ReconstructOptions& options, std::uint64_t bricks) {
  if (options.method == Method::intersection) {
    using Node = std::array<std::uint32_t, 8>;
    return pool_bytes<Brick>(bricks) + pool_bytes<Node>(bricks);  // a node has at least one child
  }
  const VoxelGrid grid = make_shell_grid(options);
  const std::size_t tables = 2 * (grid.brick_count() * sizeof(std::uint32_t) + grid.block_count());
  return pool_bytes<TsdfBrick>(bricks) + pool_bytes<CompactBrick>(bricks) +
         static_cast<std::size_t>(bricks) * sizeof(ShellBrick) + tables;
}

int plan_threads(const ReconstructOptions& options) {
  if (options.memory_limit == 0) {
    return options.threads;
  }
  check_memory_limit(options.memory_limit,
                     options.program_memory + thread_bytes(options) + mebibyte);
  const std::size_t room = options.memory_limit - options.program_memory;
  return std::min(options.threads, static_cast<int>(room / thread_bytes(options)));
}

TileRoom room_for(const ReconstructOptions& options, const Tile& tile) {
  if (options.memory_limit == 0) {
    return {.threads = options.threads, .bytes = std::numeric_limits<std::size_t>::max()};
  }
  // Each thread has its own octrees, which are merged.
  const bool has_copies = options.method == Method::intersection;
  for (int threads = options.threads; threads > 0; --threads) {
    const auto count = static_cast<std::size_t>(threads);
    const std::size_t taken = options.program_memory + count * thread_bytes(options);
    const std::size_t copies = has_copies ? count : 1;
    if (taken + copies * tile.bytes <= options.memory_limit) {
      return {.threads = threads, .bytes = (options.memory_limit - taken) / copies};
    }
  }
  refuse(options, tile.index, tile_memory(options, tile));
}

std::size_t shell_surface_bytes(const ReconstructOptions& options,
                                std::span<const TileBrick> bricks) {
  std::map<std::array<int, 3>, std::size_t> layers;  // bricks in each layer of each column
  constexpr int column = shell_column_side / VoxelGrid::brick_side;
  std::size_t largest = 0;
  for (const TileBrick& at : bricks) {
    largest = std::max(largest, ++layers[{at.z, at.y / column, at.x / column}]);
  }
  const auto height =
      static_cast<std::size_t>(make_shell_grid(options).size().z) * VoxelGrid::brick_side;
  const std::size_t width = std::min<std::size_t>(height, shell_column_side);
  return bricks.size() * sizeof(ShellBrick) + width * width * height / 8 +
         std::max(window_bytes, largest * layer_brick_bytes);
}

void expect_surface_room(const ReconstructOptions& options, const TileIndex& tile,
                         std::span<const TileBrick> bricks) {
  const std::size_t surface = shell_surface_bytes(options, bricks);
  if (options.memory_limit != 0 && options.program_memory + surface > options.memory_limit) {
    refuse(options, tile,
           options.program_memory + surface + surface / 4);  // margin for bumpy walls
  }
}

std::size_t tile_memory(const ReconstructOptions& options, const Tile& tile) {
  return options.program_memory + thread_bytes(options) + tile.bytes;
}

}  // namespace octurn
