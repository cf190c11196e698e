#include "tsdf/compact_tsdf.hpp"

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

// What a sample needs to count as seen: of one good reading a tenth, and no less than the snapshots
// that saw through.
constexpr float least_weight = 0.1F;

/// @param free  snapshots that saw through the sample
VoxelState sighted(const TsdfBrick& brick, std::size_t sample, int free) {
  const float w = static_cast<float>(brick.weight[sample]) / TsdfVolume::weight_ticks;
  if (w >= least_weight && w >= static_cast<float>(free)) {
    return VoxelState::seen;
  }
  if (free > 0) {
    return VoxelState::free;
  }
  return brick.distance[sample] < 0 && w > 0 ? VoxelState::behind : VoxelState::unknown;
}

/// @param position  of the brick
CompactBrick seen(const TsdfVolume& field, const TsdfBrick& from, const Index3& position) {
  const int per_brick = field.blocks_per_brick();
  const int leaves = field.block_voxels();
  std::array<int, Brick::side> free{};  // of the samples of a row, by their cells
  CompactBrick brick{.distance = from.distance, .sighted = {}};
  std::size_t sample = 0;
  for (int z = 0; z < Brick::side; ++z) {
    for (int y = 0; y < Brick::side; ++y) {
      if (y % leaves == 0) {
        for (int x = 0; x < Brick::side; ++x) {
          free[static_cast<std::size_t>(x)] = field.free_cell(
              {position.x * per_brick + x / leaves, position.y * per_brick + y / leaves,
               position.z * per_brick + z / leaves});
        }
      }
      for (const int of_cell : free) {
        brick.set(sample, sighted(from, sample, of_cell + from.free[sample]));
        ++sample;
      }
    }
  }
  return brick;
}

}  // namespace

CompactTsdf::CompactTsdf(const VoxelGrid& shape)
    : VoxelGrid(shape), bricks_(brick_count()), free_(cell_count()) {}

void CompactTsdf::add(const TsdfVolume& field, const std::stop_token& stop) {
  const auto& [low, end] = field.layers();
  for (int z = low; z < end; ++z) {
    throw_if_stopped(stop);
    for (int y = 0; y < size().y; ++y) {
      for (int x = 0; x < size().x; ++x) {
        if (const TsdfBrick* brick = field.find({x, y, z})) {
          bricks_.add(brick_index({x, y, z})) = seen(field, *brick, {x, y, z});
        }
      }
    }
  }
  const int per_brick = blocks_per_brick();
  for (int z = low * per_brick; z < end * per_brick; ++z) {
    for (int y = 0; y < size().y * per_brick; ++y) {
      for (int x = 0; x < size().x * per_brick; ++x) {
        free_[cell_index({x, y, z})] = field.free_cell({x, y, z}) > 0 ? 1 : 0;
      }
    }
  }
}

}  // namespace octurn
