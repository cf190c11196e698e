#pragma once

#include <array>
#include <utility>

#include "octurn/snapshot.hpp"
#include "tsdf/voxel_grid.hpp"
#include "voxel/index3.hpp"

namespace octurn {

/// The half-space below the platform of one of several poses. It holds nothing of the object.
class PlatformCut {
 public:
  PlatformCut(const VoxelGrid& grid, const Placement& placement);

  /// Height of a voxel's centre above the platform, in ticks of the grid's truncation.
  float height(const Index3& voxel) const {
    return offset_ + step_[0] * static_cast<float>(voxel.x) +
           step_[1] * static_cast<float>(voxel.y) + step_[2] * static_cast<float>(voxel.z);
  }

  /// The minimum and maximum height in the half-open box of voxels from `low` on.
  std::pair<float, float> heights(const Index3& low, const Index3& size) const;

  /// The voxel right above a lower one, at that height in ticks.
  Index3 raised(const Index3& voxel, float to_height) const;

 private:
  std::array<float, 3> step_ = {};  // ticks for a voxel along each axis
  float offset_ = 0;                // of the voxel (0, 0, 0)
  float square_ = 1;                // squared length of the steps
};

}  // namespace octurn
