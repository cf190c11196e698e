#include "tsdf/known_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

// The distance that free voxels contribute to the fill. A smaller one would leave more of the
// unobserved space inside the model.
constexpr float free_distance = 0.8F * VoxelGrid::ticks;

struct RunningMean {
  int count = 0;
  float sum = 0;  // ticks
  void add(float distance) {
    ++count;
    sum += distance;
  }
};

/// The observations and platforms from which blocks are classified.
struct Knowledge {
  const CompactTsdf& tsdf;
  int base_layer = 0;
  std::span<const PlatformCut> platforms = {};
};

/// Whether the centre of a block lies below one of the platforms.
bool is_below_platform(const Knowledge& known, const Index3& block) {
  const VoxelGrid& grid = known.tsdf.grid();
  const int voxels = grid.block_voxels();
  const auto centre = [&](int at, int low) {
    return (at + low * grid.blocks_per_brick()) * voxels + voxels / 2;
  };
  const Index3 voxel{centre(block.x, grid.low().x), centre(block.y, grid.low().y),
                     centre(block.z, grid.low().z)};
  return std::ranges::any_of(
      known.platforms, [&](const PlatformCut& platform) { return platform.height(voxel) < 0; });
}

/// The mean distance of a block's known voxels from the base layer up. Occluded voxels count,
/// however small their weight: they show that there is something to fill.
/// @param position  of the brick
RunningMean mean_known_distance(const Knowledge& known, const CompactBrick& brick,
                                const Index3& position, const Index3& block) {
  const VoxelGrid& grid = known.tsdf.grid();
  const bool is_free_known = !is_below_platform(known, block);
  const int per_brick = grid.blocks_per_brick();
  const int voxels = grid.block_voxels();
  RunningMean mean;
  for (int z = 0; z < voxels; ++z) {
    const int bz = block.z % per_brick * voxels + z;
    if ((position.z + grid.low().z) * brick_side + bz < known.base_layer) {
      continue;
    }
    for (int y = 0; y < voxels; ++y) {
      for (int x = 0; x < voxels; ++x) {
        const auto sample = static_cast<std::size_t>(
            block.x % per_brick * voxels + x + (block.y % per_brick * voxels + y) * brick_side +
            bz * brick_side * brick_side);
        switch (brick.state(sample)) {
          case VoxelState::observed:
          case VoxelState::occluded:
            mean.add(std::min(static_cast<float>(brick.distance[sample]), free_distance));
            break;
          case VoxelState::free:
            if (is_free_known) {
              mean.add(free_distance);
            }
            break;
          case VoxelState::unknown:
            break;
        }
      }
    }
  }
  return mean;
}

/// Sets `low` and `end`.
void find_box(const CompactTsdf& known, KnownBlocks& blocks) {
  const Index3& size = known.grid().size();
  Index3 first = size;
  Index3 last{-1, -1, -1};
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        if (known.find({x, y, z}) != nullptr) {
          first = {std::min(first.x, x), std::min(first.y, y), std::min(first.z, z)};
          last = {std::max(last.x, x), std::max(last.y, y), std::max(last.z, z)};
        }
      }
    }
  }
  if (last.x >= 0) {
    // A volume that ends at the platform has a border of one brick below, of which nothing is
    // known.
    const bool ends_at_platform = known.grid().low().z == -1;
    blocks.low = {first.x - 1, first.y - 1, ends_at_platform ? 1 : first.z - 1};
    blocks.end = {last.x + 2, last.y + 2, std::min(last.z + 2, size.z)};
  }
}

constexpr std::size_t observed_per_stray = 1000;

/// Half of a k-DOP's directions. The other half are their opposites.
constexpr std::array<Index3, 13> directions = {{{1, 0, 0},
                                                {0, 1, 0},
                                                {0, 0, 1},
                                                {1, 1, 0},
                                                {1, -1, 0},
                                                {1, 0, 1},
                                                {1, 0, -1},
                                                {0, 1, 1},
                                                {0, 1, -1},
                                                {1, 1, 1},
                                                {1, 1, -1},
                                                {1, -1, 1},
                                                {-1, 1, 1}}};

int along(const Index3& direction, const Index3& block) {
  return direction.x * block.x + direction.y * block.y + direction.z * block.z;
}

/// Calls `visit(block, index)` for each block of a grid.
template <typename Visit>
void for_each_block(const Index3& size, Visit visit) {
  std::size_t index = 0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x, ++index) {
        visit(Index3{x, y, z}, index);
      }
    }
  }
}

/// The blocks between two planes across a direction.
struct HullSlab {
  Index3 direction = {};
  int low = 0;
  int high = 0;
};

/// @param blocks  at least one; reordered
HullSlab make_slab(const Index3& direction, std::vector<Index3>& blocks, int reach) {
  const auto strays = static_cast<std::ptrdiff_t>(blocks.size() / observed_per_stray);
  const auto by_distance = [&](const Index3& block) { return along(direction, block); };
  std::ranges::nth_element(blocks, blocks.begin() + strays, {}, by_distance);
  const int low = by_distance(blocks[static_cast<std::size_t>(strays)]);
  std::ranges::nth_element(blocks, blocks.end() - 1 - strays, {}, by_distance);
  const int high = by_distance(blocks[blocks.size() - 1 - static_cast<std::size_t>(strays)]);
  return {.direction = direction, .low = low - reach, .high = high + reach};
}

/// Sets the value of a block, if it is known.
/// @param block  indexed in the TSDF's grid
/// @param index  of the block in `distances`
void classify_block(const Knowledge& known, const Index3& block, std::size_t index,
                    PartialGrid& distances) {
  const VoxelGrid& grid = known.tsdf.grid();
  const int per_brick = grid.blocks_per_brick();
  const int voxels = grid.block_voxels();
  const Index3 position{block.x / per_brick, block.y / per_brick, block.z / per_brick};
  const auto set = [&](float distance) {
    distances.values[index] = distance;
    distances.known[index] = 1;
  };
  const CompactBrick* const brick = known.tsdf.find(position);
  const bool is_free = grid.is_border(position) || (brick == nullptr && known.tsdf.is_free(block));
  if (is_free && !is_below_platform(known, block)) {
    set(free_distance);
  } else if (brick != nullptr) {
    const RunningMean mean = mean_known_distance(known, *brick, position, block);
    if (mean.count * 4 >= voxels * voxels * voxels) {
      set(mean.sum / static_cast<float>(mean.count));
    }
  }
}

}  // namespace

KnownBlocks known_blocks(const CompactTsdf& known, int base_layer,
                         std::span<const PlatformCut> platforms, const std::stop_token& stop,
                         ThreadTeam& team) {
  const Knowledge knowledge{.tsdf = known, .base_layer = base_layer, .platforms = platforms};
  KnownBlocks blocks;
  find_box(known, blocks);
  const int per_brick = known.grid().blocks_per_brick();
  const Index3 low{blocks.low.x * per_brick, blocks.low.y * per_brick, blocks.low.z * per_brick};
  PartialGrid& distances = blocks.distances;
  distances.size = {blocks.end.x * per_brick - low.x, blocks.end.y * per_brick - low.y,
                    blocks.end.z * per_brick - low.z};
  const auto count = distances.index(0, 0, distances.size.z);
  distances.values.resize(count);
  distances.known.resize(count);
  team.for_each(distances.size.z, [&](int z) {
    throw_if_stopped(stop);
    std::size_t index = distances.index(0, 0, z);
    for (int y = 0; y < distances.size.y; ++y) {
      for (int x = 0; x < distances.size.x; ++x, ++index) {
        classify_block(knowledge, {low.x + x, low.y + y, low.z + z}, index, distances);
      }
    }
  });
  return blocks;
}

void limit_bulges(KnownBlocks& blocks, const VoxelGrid& grid, double max_bulge) {
  PartialGrid& distances = blocks.distances;
  std::vector<Index3> observed;
  for_each_block(distances.size, [&](const Index3& block, std::size_t index) {
    if (distances.known[index] != 0 && distances.values[index] < free_distance) {
      observed.push_back(block);
    }
  });
  if (observed.empty()) {
    return;
  }
  const double side = grid.voxel_side() * grid.block_voxels();
  std::vector<HullSlab> hull;
  for (const Index3& direction : directions) {
    const double length = std::sqrt(static_cast<double>(along(direction, direction)));
    hull.push_back(
        make_slab(direction, observed, static_cast<int>(std::ceil(max_bulge * length / side))));
  }
  for_each_block(distances.size, [&](const Index3& block, std::size_t index) {
    if (distances.known[index] == 0 && std::ranges::any_of(hull, [&](const HullSlab& slab) {
          const int at = along(slab.direction, block);
          return at < slab.low || at > slab.high;
        })) {
      distances.values[index] = free_distance;
      distances.known[index] = 1;
    }
  });
}

}  // namespace octurn
