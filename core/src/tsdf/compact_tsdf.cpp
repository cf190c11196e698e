#include "tsdf/compact_tsdf.hpp"

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

/// A surface is observed from this weight on: a tenth of that of one good reading.
constexpr float min_weight = 0.1F;

/// A voxel is observed if its weight reaches the minimum, and one for each ray that passed through.
/// @param free  snapshots whose ray passed through the voxel
/// @param min_free  that make it free space
VoxelState state_of(const TsdfBrick& brick, std::size_t sample, int free, int min_free) {
  const float w = static_cast<float>(brick.weight[sample]) / TsdfVolume::weight_ticks;
  if (w >= min_weight && w >= static_cast<float>(free)) {
    return VoxelState::observed;
  }
  if (free >= min_free) {
    return VoxelState::free;
  }
  return brick.distance[sample] < 0 && w > 0 ? VoxelState::occluded : VoxelState::unknown;
}

CompactBrick compact(const TsdfVolume& volume, const TsdfBrick& from, const Index3& index,
                     int min_free) {
  constexpr int side = VoxelGrid::brick_side;
  const int per_brick = volume.grid().blocks_per_brick();
  const int voxels = volume.grid().block_voxels();
  std::array<int, side> free{};  // counts of the blocks that a row of voxels crosses
  CompactBrick brick{.distance = from.distance, .states = {}};
  std::size_t sample = 0;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      if (y % voxels == 0) {
        for (int x = 0; x < side; ++x) {
          free[static_cast<std::size_t>(x)] =
              volume.free_count({index.x * per_brick + x / voxels, index.y * per_brick + y / voxels,
                                 index.z * per_brick + z / voxels});
        }
      }
      for (const int of_block : free) {
        brick.set_state(sample, state_of(from, sample, of_block + from.free[sample], min_free));
        ++sample;
      }
    }
  }
  return brick;
}

}  // namespace

CompactTsdf::CompactTsdf(const VoxelGrid& grid, int min_free)
    : grid_(grid), min_free_(min_free), bricks_(grid.brick_count()), free_(grid.block_count()) {}

void CompactTsdf::add(const TsdfVolume& volume, const std::stop_token& stop) {
  const auto& [low, end] = volume.layers();
  const Index3& size = grid_.size();
  for (int z = low; z < end; ++z) {
    throw_if_stopped(stop);
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        if (const TsdfBrick* brick = volume.find({x, y, z})) {
          bricks_.add(grid_.brick_index({x, y, z})) = compact(volume, *brick, {x, y, z}, min_free_);
        }
      }
    }
  }
  const int per_brick = grid_.blocks_per_brick();
  for (int z = low * per_brick; z < end * per_brick; ++z) {
    for (int y = 0; y < size.y * per_brick; ++y) {
      for (int x = 0; x < size.x * per_brick; ++x) {
        free_[grid_.block_index({x, y, z})] = volume.free_count({x, y, z}) >= min_free_ ? 1 : 0;
      }
    }
  }
}

}  // namespace octurn
