#pragma once

#include <cstdint>

#include "support/random.hpp"
#include "tsdf/compact_tsdf.hpp"

namespace octurn {

/// Calls `visit(brick index)` for each brick of a grid except its border.
template <typename Visit>
void for_each_inner_brick(const VoxelGrid& grid, Visit visit) {
  for (int z = 1; z + 1 < grid.size().z; ++z) {
    for (int y = 1; y + 1 < grid.size().y; ++y) {
      for (int x = 1; x + 1 < grid.size().x; ++x) {
        visit(Index3{x, y, z});
      }
    }
  }
}

/// A TSDF of noise: any pattern of signs, distances from one tick to a truncation, voxels that are
/// observed, free and unknown side by side.
inline CompactTsdf random_field(std::uint32_t seed, double density) {
  TsdfVolume volume(
      VoxelGrid(1.0, 10, {.min = {-0.007, -0.007, 0.002}, .max = {0.007, 0.007, 0.02}}, 0.0035));
  Random random(seed);
  for_each_inner_brick(volume.grid(), [&](const Index3& index) {
    TsdfBrick& brick = *volume.make(index);
    for (std::size_t i = 0; i < TsdfBrick::samples; ++i) {
      const int max_ticks = random.chance(0.3) ? 3 : TsdfVolume::ticks;
      const int ticks = random.between(1, max_ticks);
      brick.distance[i] = static_cast<std::int16_t>(random.chance(density) ? -ticks : ticks);
      brick.weight[i] = pack(random.chance(0.9) ? 1.0F : 0.0F);
      brick.free[i] = random.chance(0.05) ? 3 : 0;
    }
  });
  CompactTsdf known(volume.grid());
  known.add(volume);
  return known;
}

}  // namespace octurn
