#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "tsdf/tsdf_volume.hpp"
#include "voxel/brick_map.hpp"

namespace octurn {

/// What all snapshots together say of a sample.
enum class VoxelState : std::uint8_t {
  unknown,
  behind,  // faintly seen, behind a surface
  free,    // seen through
  seen,    // near a surface that enough was seen of
};

/// 8 x 8 x 8 samples, x + 8 y + 64 z: distances to the surface, positive outside, in ticks, and two
/// bits for each of what is known.
struct CompactBrick {
  std::array<std::int16_t, TsdfBrick::samples> distance = {};
  std::array<std::uint8_t, TsdfBrick::samples / 4> sighted = {};

  VoxelState at(std::size_t sample) const {
    return static_cast<VoxelState>(sighted[sample / 4] >> sample % 4 * 2 & 3);
  }
  void set(std::size_t sample, VoxelState value) {
    sighted[sample / 4] = static_cast<std::uint8_t>(sighted[sample / 4] |
                                                    static_cast<unsigned>(value) << sample % 4 * 2);
  }
};

/// What is left of a distance field when all snapshots are fused: less than half its size, so that
/// a field which is made in slabs has room as a whole.
class CompactTsdf : public VoxelGrid {
 public:
  explicit CompactTsdf(const VoxelGrid& shape);

  /// Takes over the layers that `field` holds. @throws Stopped
  void add(const TsdfVolume& field, const std::stop_token& stop = {});

  /// A brick, if it exists.
  const CompactBrick* find(const Index3& brick) const { return bricks_.find(brick_index(brick)); }

  /// Whether any snapshot saw through a cell.
  bool is_free(const Index3& cell) const { return free_[cell_index(cell)] != 0; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  BrickMap<CompactBrick> bricks_;
  std::vector<std::uint8_t> free_;
};

}  // namespace octurn
