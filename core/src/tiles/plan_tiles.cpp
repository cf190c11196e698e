#include "tiles/plan_tiles.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "bennett/triangulate.hpp"
#include "depth/back_project.hpp"
#include "io/number_text.hpp"
#include "octurn/error.hpp"
#include "parallel/fork_join.hpp"
#include "tiles/make_tiles.hpp"
#include "tiles/tile_lattice.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/shell.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/block_pool.hpp"
#include "voxel/memory_limit.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

constexpr int ray_spacing = 16;  // pixels between rays that are traced through tiles

/// The set of occupied bricks: one bit for each, stored in a `Brick` whose bits stand for bricks
/// instead of leaves. One set serves all tiles: noise reaches into many tiles, and an octree for
/// each took more memory than its bricks.
class SeenBricks {
 public:
  explicit SeenBricks(const TileLattice& lattice) : lattice_(lattice) {}

  /// Adds all bricks of a box. @param low, high  its corners
  void add(const LatticePoint& low, const LatticePoint& high) {
    std::array<int, 3> first{};
    std::array<int, 3> last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = static_cast<int>(lattice_.leaf_at(low[axis]) >> Brick::levels);
      last[axis] = static_cast<int>(lattice_.leaf_at(high[axis]) >> Brick::levels);
    }
    if (first == first_ && last == last_) {
      return;  // neighbouring samples mostly lie in the same bricks
    }
    first_ = first;
    last_ = last;
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          add_brick(x, y, z);
        }
      }
    }
  }

  void merge(const SeenBricks& other) {
    for (const auto& [at, block] : other.blocks_) {
      std::ranges::transform(blocks_[at].layers, block.layers, blocks_[at].layers.begin(),
                             std::bit_or());
    }
  }

  /// The number of bricks in each tile that has any.
  std::map<TileIndex, std::uint64_t> per_tile() const {
    const int bits = lattice_.levels() - Brick::levels;
    std::map<TileIndex, std::uint64_t> counts;
    for (const auto& [at, block] : blocks_) {
      for (int z = 0; z < Brick::side; ++z) {
        const std::uint64_t layer = block.layers[static_cast<std::size_t>(z)];
        for (std::uint64_t rest = layer; rest != 0; rest &= rest - 1) {
          const int bit = std::countr_zero(rest);
          ++counts[{.x = (at[0] * Brick::side + bit % Brick::side) >> bits,
                    .y = (at[1] * Brick::side + bit / Brick::side) >> bits,
                    .z = (at[2] * Brick::side + z) >> bits}];
        }
      }
    }
    return counts;
  }

 private:
  void add_brick(int x, int y, int z) {
    constexpr int mask = Brick::side - 1;
    Brick& block = blocks_[{x >> Brick::levels, y >> Brick::levels, z >> Brick::levels}];
    block.layers[static_cast<std::size_t>(z & mask)] |= std::uint64_t{1}
                                                        << ((x & mask) + (y & mask) * Brick::side);
  }

  const TileLattice& lattice_;
  std::map<std::array<int, 3>, Brick> blocks_ = {};  // by coordinates
  std::array<int, 3> first_ = {};
  std::array<int, 3> last_ = {-1, -1, -1};
};

/// The bounding box of some points: its minimum and maximum corner.
std::pair<LatticePoint, LatticePoint> bounds(std::initializer_list<LatticePoint> points) {
  std::pair<LatticePoint, LatticePoint> box{*points.begin(), *points.begin()};
  for (const LatticePoint& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = std::min(box.first[axis], point[axis]);
      box.second[axis] = std::max(box.second[axis], point[axis]);
    }
  }
  return box;
}

void add_triangles(const PointGrid& grid, double threshold, const TileLattice& lattice,
                   SeenBricks& seen) {
  triangulate(grid, static_cast<float>(threshold),
              [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
                const auto p = lattice.snap(a);
                const auto q = lattice.snap(b);
                const auto r = lattice.snap(c);
                if (p && q && r) {
                  const auto [low, high] = bounds({*p, *q, *r});
                  seen.add(low, high);
                }
              });
}

/// Adds the bricks that integration may change at each reading: along its ray, from one truncation
/// in front of it to `max_behind` truncations behind it.
void add_readings(const PointGrid& grid, const Eigen::Vector3f& eye, const TileLattice& lattice,
                  double truncation, SeenBricks& seen) {
  for (const Eigen::Vector3f& point : grid.points) {
    if (!is_point(point)) {
      continue;
    }
    const Eigen::Vector3f step = static_cast<float>(truncation) * (point - eye).normalized();
    const auto near = lattice.snap(point - step);
    const auto far = lattice.snap(point + max_behind * step);
    if (near && far) {
      const auto [low, high] = bounds({*near, *far});
      seen.add(low, high);
    }
  }
}

/// The tiles that rays cross between the sensor and their readings.
std::set<TileIndex> crossed_tiles(const PointGrid& grid, const Eigen::Vector3f& eye,
                                  const TileLattice& lattice) {
  std::set<TileIndex> tiles;
  const auto step = static_cast<float>(lattice.root_side() / 4);
  for (int v = 0; v < grid.height; v += ray_spacing) {
    for (int u = 0; u < grid.width; u += ray_spacing) {
      const Eigen::Vector3f& point = grid.points[static_cast<std::size_t>(v * grid.width + u)];
      if (!is_point(point)) {
        continue;
      }
      const auto steps = static_cast<int>((point - eye).norm() / step) + 1;
      for (int i = 0; i <= steps; ++i) {
        const float part = static_cast<float>(i) / static_cast<float>(steps);
        if (const auto at = lattice.snap(eye + part * (point - eye))) {
          const auto tile = [&](std::size_t axis) {
            return lattice.tile_at(lattice.leaf_at((*at)[axis]));
          };
          tiles.insert({.x = tile(0), .y = tile(1), .z = tile(2)});
        }
      }
    }
  }
  return tiles;
}

/// The tiles that one snapshot observes.
struct Seen {
  std::set<TileIndex> tiles = {};  // may include tiles without a brick
  std::uint64_t checksum = 0;
};

Seen look(const Snapshot& snapshot, const ReconstructOptions& options, const TileLattice& lattice,
          SeenBricks& bricks) {
  PointGrid grid = world_points(snapshot);
  clip(grid, options.clip);
  SeenBricks own(lattice);
  Seen seen{.tiles = {}, .checksum = compute_checksum(snapshot)};
  if (options.method == Method::intersection) {
    add_triangles(grid, options.threshold, lattice, own);
  } else {
    const Eigen::Vector3f eye = snapshot.object_from_sensor.translation().cast<float>();
    add_readings(grid, eye, lattice, make_shell_grid(options).truncation(), own);
    seen.tiles = crossed_tiles(grid, eye, lattice);
  }
  for (const auto& [tile, ignored] : own.per_tile()) {
    seen.tiles.insert(tile);
  }
  bricks.merge(own);
  return seen;
}

TilePlan make_plan(const SeenBricks& bricks, const std::vector<Seen>& seen,
                   const ReconstructOptions& options) {
  TilePlan plan;
  std::map<TileIndex, std::size_t> numbers;
  for (const auto& [index, count] : bricks.per_tile()) {
    numbers[index] = plan.tiles.size();
    plan.tiles.push_back({.index = index, .bytes = tile_bytes(options, count)});
  }
  for (std::size_t snapshot = 0; snapshot < seen.size(); ++snapshot) {
    plan.snapshots.push_back(seen[snapshot].checksum);
    for (const TileIndex& tile : seen[snapshot].tiles) {
      if (const auto found = numbers.find(tile); found != numbers.end()) {
        plan.tiles[found->second].snapshots.push_back(snapshot);
      }
    }
  }
  return plan;
}

}  // namespace

TilePlan plan_tiles(const ReconstructOptions& options, const SnapshotSource& snapshots,
                    const std::stop_token& stop) {
  const TileLattice lattice(options);
  const int threads =
      std::max(1, std::min(plan_threads(options), static_cast<int>(snapshots.count)));
  std::vector<SeenBricks> bricks;  // of each thread
  bricks.reserve(static_cast<std::size_t>(threads));
  for (int thread = 0; thread < threads; ++thread) {
    bricks.emplace_back(lattice);
  }
  std::vector<Seen> seen(snapshots.count);
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int thread) {
    for (std::size_t shot = next++; shot < snapshots.count; shot = next++) {
      throw_if_stopped(stop);
      seen[shot] =
          look(snapshots.read(shot), options, lattice, bricks[static_cast<std::size_t>(thread)]);
    }
  });
  for (std::size_t i = 1; i < bricks.size(); ++i) {
    bricks.front().merge(bricks[i]);
  }
  return make_plan(bricks.front(), seen, options);
}

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

namespace {

/// The memory for drawing and simplifying a tile's surface by the method `solid`, bytes.
/// @param bricks  of the tile, as in `TileBricks`
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

}  // namespace

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
