#include "tsdf/platform_cut.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace octurn {

PlatformCut::PlatformCut(const VoxelGrid& grid, const Placement& placement) {
  const Eigen::Isometry3d platform_from_object = placement.object_from_platform.inverse();
  const Eigen::Vector3d up = platform_from_object.linear().row(2);
  const double ticks_per_metre = VoxelGrid::ticks / grid.truncation();
  double offset = platform_from_object.translation().z();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = up[static_cast<Eigen::Index>(axis)];
    step_[axis] = static_cast<float>(along * grid.voxel_side() * ticks_per_metre);
    offset += along * grid.centre(0, axis);
  }
  offset_ = static_cast<float>(offset * ticks_per_metre);
  square_ = step_[0] * step_[0] + step_[1] * step_[1] + step_[2] * step_[2];
}

std::pair<float, float> PlatformCut::heights(const Index3& low, const Index3& size) const {
  float lowest = height(low);
  float highest = lowest;
  const std::array<int, 3> steps{size.x - 1, size.y - 1, size.z - 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float along = step_[axis] * static_cast<float>(steps[axis]);
    lowest += std::min(along, 0.0F);
    highest += std::max(along, 0.0F);
  }
  return {lowest, highest};
}

Index3 PlatformCut::raised(const Index3& voxel, float to_height) const {
  const float steps = (to_height - height(voxel)) / square_;
  const auto moved = [&](int at, std::size_t axis) {
    return at + static_cast<int>(std::lround(step_[axis] * steps));
  };
  return {moved(voxel.x, 0), moved(voxel.y, 1), moved(voxel.z, 2)};
}

}  // namespace octurn
