#pragma once

#include "support/random.hpp"
#include "tsdf/compact_tsdf.hpp"

namespace octurn {

/// A field of noise: any pattern of signs, distances from the least to the greatest, samples that
/// are seen, free and unknown side by side.
inline CompactTsdf random_field(std::uint32_t seed, double density) {
  TsdfVolume field(
      VoxelGrid(1.0, 10, {.min = {-0.007, -0.007, 0.002}, .max = {0.007, 0.007, 0.02}}, 0.0035));
  Random random(seed);
  for (int z = 1; z + 1 < field.size().z; ++z) {
    for (int y = 1; y + 1 < field.size().y; ++y) {
      for (int x = 1; x + 1 < field.size().x; ++x) {
        TsdfBrick& brick = *field.make({x, y, z});
        for (std::size_t i = 0; i < TsdfBrick::samples; ++i) {
          const int most = random.chance(0.3) ? 3 : TsdfVolume::ticks;
          const int ticks = random.between(1, most);
          brick.distance[i] = static_cast<std::int16_t>(random.chance(density) ? -ticks : ticks);
          brick.weight[i] = random.chance(0.9) ? TsdfVolume::weight_ticks : 0;
          brick.free[i] = random.chance(0.05) ? 2 : 0;
        }
      }
    }
  }
  CompactTsdf seen(field);
  seen.add(field);
  return seen;
}

}  // namespace octurn
