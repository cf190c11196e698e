#include "tsdf/compact_tsdf.hpp"

#include <algorithm>

#include "octurn/snapshot.hpp"
#include "tsdf/integration_model.hpp"

namespace octurn {
namespace {

/// Minimum weight of an observed surface: a tenth of the weight of one good reading.
constexpr float min_weight = 0.1F;

/// A voxel is free if it has enough votes, and more than its surface weight times the votes of one
/// ray.
/// @param votes      of the rays that passed through the voxel
/// @param min_votes  minimum for free space
VoxelState to_state(const TsdfBrick& brick, std::size_t sample, int votes, int min_votes) {
  const float w = unpack(brick.weight[sample]);
  const bool is_surface = w >= min_weight;
  if (votes >= min_votes &&
      !(is_surface && w * votes_of_surface_ray >= static_cast<float>(votes))) {
    return VoxelState::free;
  }
  if (is_surface) {
    return VoxelState::observed;
  }
  return brick.distance[sample] < 0 && w > 0 ? VoxelState::occluded : VoxelState::unknown;
}

/// Whether any snapshot observed a surface in a brick. A brick may have only votes of free space.
bool has_surface(const TsdfBrick& brick) {
  return std::ranges::any_of(brick.weight, [](PackedWeight weight) { return weight != 0; });
}

CompactBrick to_compact(const TsdfVolume& volume, const TsdfBrick& from, const Index3& index,
                        int min_votes) {
  constexpr int side = VoxelGrid::brick_side;
  const int per_brick = volume.grid().blocks_per_brick();
  const int voxels = volume.grid().block_voxels();
  std::array<int, side> free{};  // votes of the blocks that a row of voxels crosses
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
        brick.set_state(sample, to_state(from, sample, of_block + from.free[sample], min_votes));
        ++sample;
      }
    }
  }
  return brick;
}

}  // namespace

CompactTsdf::CompactTsdf(const VoxelGrid& grid, int min_votes)
    : grid_(grid), min_votes_(min_votes), bricks_(grid.brick_count()), free_(grid.block_count()) {}

void CompactTsdf::add(const TsdfVolume& volume, const std::stop_token& stop, ThreadTeam& team) {
  const BrickLayers& layers = volume.layers();
  std::mutex adding;
  team.for_each(layers.end - layers.low, [&](int layer) {
    throw_if_stopped(stop);
    add_layer(volume, layers.low + layer, adding);
    add_free_blocks(volume, layers.low + layer);
  });
}

/// @param z       of a layer of bricks
/// @param adding  held while the table of bricks grows
void CompactTsdf::add_layer(const TsdfVolume& volume, int z, std::mutex& adding) {
  const auto make = [&](const Index3& brick) -> CompactBrick& {
    const std::lock_guard lock(adding);
    return bricks_.add(grid_.brick_index(brick));
  };
  for (int y = 0; y < grid_.size().y; ++y) {
    for (int x = 0; x < grid_.size().x; ++x) {
      if (const TsdfBrick* brick = volume.find({x, y, z});
          brick != nullptr && has_surface(*brick)) {
        make({x, y, z}) = to_compact(volume, *brick, {x, y, z}, min_votes_);
      }
    }
  }
}

/// @param z  of a layer of bricks
void CompactTsdf::add_free_blocks(const TsdfVolume& volume, int z) {
  const Index3& size = grid_.size();
  const int per_brick = grid_.blocks_per_brick();
  for (int block = z * per_brick; block < (z + 1) * per_brick; ++block) {
    for (int y = 0; y < size.y * per_brick; ++y) {
      for (int x = 0; x < size.x * per_brick; ++x) {
        free_[grid_.block_index({x, y, block})] =
            volume.free_count({x, y, block}) >= min_votes_ ? 1 : 0;
      }
    }
  }
}

}  // namespace octurn
