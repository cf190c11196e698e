#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <vector>

#include "parallel/thread_team.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/block_pool.hpp"

namespace octurn {

/// State of a voxel after all snapshots.
enum class VoxelState : std::uint8_t {
  unknown,   ///< no snapshot saw it
  occluded,  ///< behind an observed surface, with too little weight to count as observed
  free,      ///< some ray passed through
  observed,  ///< within the truncation of a surface, with enough weight
};

/// 8 x 8 x 8 samples in the order of `TsdfBrick`: signed distances, and the states in two bits
/// each.
struct CompactBrick {
  std::array<std::int16_t, TsdfBrick::samples> distance = {};  // ticks, positive outside
  std::array<std::uint8_t, TsdfBrick::samples / 4> states = {};

  VoxelState state(std::size_t sample) const {
    return static_cast<VoxelState>(states[sample / 4] >> sample % 4 * 2 & 3);
  }
  /// Sets a state that is still unknown.
  void set_state(std::size_t sample, VoxelState value) {
    states[sample / 4] = static_cast<std::uint8_t>(states[sample / 4] | static_cast<unsigned>(value)
                                                                            << sample % 4 * 2);
  }
};

/// A finished TSDF without its weights, and without bricks in which no surface was observed. It has
/// less than half the size of a `TsdfVolume`, so that a volume that was integrated slab by slab
/// fits in memory as a whole.
class CompactTsdf {
 public:
  /// @param min_votes  of rays that passed through a voxel (`votes_of_any_ray`) to call it free
  explicit CompactTsdf(const VoxelGrid& grid, int min_votes = 1);

  const VoxelGrid& grid() const { return grid_; }

  /// Copies the layers that `volume` holds. @throws Stopped
  void add(const TsdfVolume& volume, const std::stop_token& stop = {},
           ThreadTeam& team = ThreadTeam::alone());

  /// The brick at an index, or null where there is none.
  const CompactBrick* find(const Index3& brick) const {
    return bricks_.find(grid_.brick_index(brick));
  }

  /// Whether enough rays passed through all of a block.
  bool is_free(const Index3& block) const { return free_[grid_.block_index(block)] != 0; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  void add_layer(const TsdfVolume& volume, int z, std::mutex& adding);
  void add_free_blocks(const TsdfVolume& volume, int z);

  VoxelGrid grid_;
  int min_votes_;
  BrickMap<CompactBrick> bricks_;
  std::vector<std::uint8_t> free_;
};

}  // namespace octurn
