#include "tsdf/voxel_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

// A block has about the size of the smallest detail that a Kinect v1 resolves, and of the band in
// which distances behind a surface are known: in a larger one free voxels outweigh them, and what
// lies inside would be filled as if it were outside.
constexpr double max_block_side = 0.004;  // metres
constexpr double block_truncations = 1.15;

int block_voxels_for(double voxel_side, double truncation) {
  const double block_side = std::min(max_block_side, block_truncations * truncation);
  int voxels = 2;
  while (voxels < VoxelGrid::brick_side && voxels * voxel_side * 1.5 < block_side) {
    voxels *= 2;
  }
  return voxels;
}

constexpr double min_truncation_voxels = 2.5;
constexpr double foot_room = 1.5;  // truncations below the platform of the first of several poses

}  // namespace

VoxelGrid::VoxelGrid(double root_side, int levels, const Box& clip, double truncation, int below)
    : root_side_(root_side),
      levels_(levels),
      voxel_side_(root_side / (1 << levels)),
      truncation_(truncation),
      block_voxels_(block_voxels_for(voxel_side_, truncation)) {
  const double brick_metres = voxel_side_ * brick_side;
  const auto bricks = [&](Eigen::Index axis) {
    const double corner = axis < 2 ? -root_side / 2 : 0.0;
    const int last = std::max((1 << levels) / brick_side, 1) - 1;
    const auto brick_at = [&](double at) {
      // Clamped before the conversion: a clip box may be far wider than int has bricks.
      const double brick = std::floor((at - corner) / brick_metres);
      return static_cast<int>(std::clamp(brick, 0.0, static_cast<double>(last)));
    };
    // The model stands on the platform, wherever the clip box begins.
    const int first = axis == 2 ? -below : brick_at(clip.min[axis]);
    return std::array{first - 1, brick_at(clip.max[axis]) - first + 3};
  };
  low_ = {bricks(0)[0], bricks(1)[0], bricks(2)[0]};
  size_ = {bricks(0)[1], bricks(1)[1], bricks(2)[1]};
}

Box VoxelGrid::box() const {
  const auto corner = [&](const Index3& brick) {
    const auto at = [&](int bricks, std::size_t axis) {
      return centre(bricks * brick_side, axis) - voxel_side_ / 2;
    };
    return Eigen::Vector3d(at(brick.x, 0), at(brick.y, 1), at(brick.z, 2));
  };
  return {.min = corner(low_),
          .max = corner({low_.x + size_.x, low_.y + size_.y, low_.z + size_.z})};
}

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

VoxelGrid make_solid_grid(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const double voxel_side = options.root_size / (1 << levels);
  const double distance = std::max(options.solid.truncation, min_truncation_voxels * voxel_side);
  // With several poses the surface of the foot may be seen from below: it needs room.
  const int below = options.placements.empty()
                        ? 0
                        : static_cast<int>(std::ceil(foot_room * distance /
                                                     (voxel_side * VoxelGrid::brick_side)));
  return {options.root_size, levels, options.clip, distance, below};
}

}  // namespace octurn
