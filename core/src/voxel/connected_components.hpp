#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "octurn/snapshot.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// Neighbouring voxels of one row: the half-open range from `first` to `end`.
struct Run {
  int first = 0;
  int end = 0;
  std::uint32_t parent = 0;
};

/// The connected components of a mask or of its complement: runs of voxels joined by union-find.
class ConnectedComponents {
 public:
  enum class Of { voxels, gaps };

  /// Connects voxels across faces, gaps across faces and edges.
  /// @param mask  must outlive this
  /// @throws Stopped
  ConnectedComponents(const VoxelMask& mask, Of of, const std::stop_token& stop);

  /// The representative run of a run's component.
  std::uint32_t root(std::uint32_t run);

  /// The number of voxels of a component, by its representative run; 0 for other runs.
  std::vector<std::uint64_t> volumes();

  /// The number of runs.
  std::size_t count() const { return runs_.size(); }

  /// Calls `visit(y, z, index, run)` for each run, row by row.
  template <typename Visit>
  void for_each(Visit visit) const {
    const Index3& size = mask_.size();
    std::size_t row = 0;
    for (int z = 0; z < size.z; ++z) {
      throw_if_stopped(stop_);
      for (int y = 0; y < size.y; ++y, ++row) {
        for (std::uint32_t i = first_[row]; i < first_[row + 1]; ++i) {
          visit(y, z, i, runs_[i]);
        }
      }
    }
  }

 private:
  void add_row(int y, int z);
  void join_row(int y, int z);
  void join(int y, int z, int reach);

  const VoxelMask& mask_;
  Of of_;
  const std::stop_token& stop_;
  std::vector<Run> runs_ = {};
  std::vector<std::uint32_t> first_ = {};  // index of each row's first run
};

/// The connected components (6-neighbours) that were removed from a mask, and their voxels.
struct DroppedComponents {
  std::uint64_t count = 0;
  std::uint64_t voxels = 0;
};

/// Keeps the largest connected component; the size of a standing one counts eightfold.
/// @param standing_layers  a component stands if it reaches into this many lowest layers of the box
/// @throws Stopped
DroppedComponents keep_main_component(VoxelMask& mask, int standing_layers = 1,
                                      const std::stop_token& stop = {});

/// Keeps the main component, and every other one that stands and has at least `min_voxels`.
/// @throws Stopped
DroppedComponents keep_standing_components(VoxelMask& mask, int standing_layers,
                                           std::uint64_t min_voxels,
                                           const std::stop_token& stop = {});

}  // namespace octurn
