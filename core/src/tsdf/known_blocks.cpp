#include "tsdf/known_blocks.hpp"

#include <algorithm>
#include <cstddef>

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

}  // namespace octurn
