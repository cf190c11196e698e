#include "tsdf/known_blocks.hpp"

#include <algorithm>
#include <cstddef>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int brick_side = VoxelGrid::brick_side;

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

/// The mean distance of a block's known samples from the base layer up. An occluded sample counts,
/// however small its weight: it says that there is something to fill.
/// @param position  of the brick
RunningMean mean_known_distance(const VoxelGrid& grid, const CompactBrick& brick,
                                const Index3& position, const Index3& block, int base_layer) {
  const int per_brick = grid.blocks_per_brick();
  const int voxels = grid.block_voxels();
  RunningMean mean;
  for (int z = 0; z < voxels; ++z) {
    const int bz = block.z % per_brick * voxels + z;
    if ((position.z + grid.low().z) * brick_side + bz < base_layer) {
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
            mean.add(free_distance);
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
void classify_block(const CompactTsdf& known, int base_layer, const Index3& block,
                    std::size_t index, PartialGrid& distances) {
  const VoxelGrid& grid = known.grid();
  const int per_brick = grid.blocks_per_brick();
  const int voxels = grid.block_voxels();
  const Index3 position{block.x / per_brick, block.y / per_brick, block.z / per_brick};
  const auto set = [&](float distance) {
    distances.values[index] = distance;
    distances.known[index] = 1;
  };
  if (grid.is_border(position)) {
    set(free_distance);
    return;
  }
  const CompactBrick* const brick = known.find(position);
  if (brick == nullptr && known.is_free(block)) {
    set(free_distance);
  } else if (brick != nullptr) {
    const RunningMean mean = mean_known_distance(grid, *brick, position, block, base_layer);
    if (mean.count * 4 >= voxels * voxels * voxels) {
      set(mean.sum / static_cast<float>(mean.count));
    }
  }
}

}  // namespace

KnownBlocks known_blocks(const CompactTsdf& known, int base_layer, const std::stop_token& stop,
                         ThreadTeam& team) {
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
        classify_block(known, base_layer, {low.x + x, low.y + y, low.z + z}, index, distances);
      }
    }
  });
  return blocks;
}

}  // namespace octurn
