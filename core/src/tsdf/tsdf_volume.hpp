#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

#include "tsdf/voxel_grid.hpp"
#include "voxel/block_pool.hpp"

namespace octurn {

/// A sum of weights in 16 bits: a floating-point number of five bits of exponent and eleven of
/// mantissa, from 2^-16 to 2^16, or 0.
///
/// No scan reaches the maximum, and every sum is rounded to 1/4096 of itself. The weighted mean
/// therefore does not depend on the sensor's distance and, except for rounding, not on the order of
/// the snapshots.
using PackedWeight = std::uint16_t;

namespace packed_weight {
inline constexpr int dropped_bits = 12;                      // of a float's mantissa
inline constexpr std::uint32_t smallest = (127 - 16) << 11;  // 2^-16 without those bits
}  // namespace packed_weight

constexpr float unpack(PackedWeight weight) {
  const std::uint32_t bits = (weight + packed_weight::smallest) << packed_weight::dropped_bits;
  return weight == 0 ? 0.0F : std::bit_cast<float>(bits);
}

/// @param weight  at least 0
constexpr PackedWeight pack(float weight) {
  constexpr std::uint32_t half = 1U << (packed_weight::dropped_bits - 1);
  const std::uint32_t bits =
      (std::bit_cast<std::uint32_t>(weight) + half) >> packed_weight::dropped_bits;
  return static_cast<PackedWeight>(
      std::clamp(bits, packed_weight::smallest, packed_weight::smallest + 0xffffU) -
      packed_weight::smallest);
}

/// TSDF samples at the centres of 8 x 8 x 8 voxels; voxel (x, y, z) has the index x + 8 y + 64 z.
struct TsdfBrick {
  static constexpr std::size_t samples = 512;
  std::array<std::int16_t, samples> distance = {};  // to the surface, ticks, positive outside
  std::array<PackedWeight, samples> weight = {};    // accumulated
  std::array<std::uint8_t, samples> free = {};      // votes of rays that passed through
};

/// A truncated signed distance function (Curless and Levoy 1996) as a dense table of bricks.
///
/// A brick exists where a snapshot observed a surface within the truncation, or saw through a part
/// of a block. A block counts the votes of the snapshots whose rays passed through all of it.
///
/// Under a memory limit the volume holds a slab: as many layers of bricks as fit, from the slab's
/// lowest layer up.
class TsdfVolume {
 public:
  static constexpr int ticks = VoxelGrid::ticks;

  /// @param max_bytes  that bricks and tables may take
  explicit TsdfVolume(const VoxelGrid& grid,
                      std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

  const VoxelGrid& grid() const { return grid_; }

  /// The slab that the volume holds.
  const BrickLayers& layers() const { return layers_; }

  /// Clears the volume, to hold the layers from `low` to the top.
  void reset_to_slab(int low, std::size_t max_bytes);

  /// The brick at an index, or null where there is none.
  const TsdfBrick* find(const Index3& brick) const {
    return bricks_.find(grid_.brick_index(brick));
  }
  TsdfBrick* find(const Index3& brick) { return bricks_.find(grid_.brick_index(brick)); }

  /// Whether all bricks of its layers would fit. Then `make` drops no layers, and several threads
  /// may call it at once for different bricks.
  bool holds_all() const;

  /// The brick at an index, made if it is missing. If it does not fit, the volume drops its top
  /// layers; null if the brick was in one of them.
  /// @throws OutOfBudget  if only one layer is left
  TsdfBrick* make(const Index3& brick);

  /// Votes (`votes_of_any_ray`) of the snapshots that saw through a whole block, up to 255.
  std::uint8_t& free_count(const Index3& block) { return free_[grid_.block_index(block)]; }
  std::uint8_t free_count(const Index3& block) const { return free_[grid_.block_index(block)]; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  void drop_top_layers();

  VoxelGrid grid_;
  std::size_t max_bytes_;
  BrickLayers layers_ = {};
  BrickMap<TsdfBrick> bricks_;
  std::vector<std::uint8_t> free_;
  std::mutex making_ = {};  // a brick
};

}  // namespace octurn
