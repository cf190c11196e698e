#include "tsdf/shell.hpp"

#include <algorithm>

#include "octurn/reconstruct.hpp"
#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

constexpr double truncation_voxels = VoxelGrid::ticks / shell_voxel_ticks;

double voxel_side(const ReconstructOptions& options) {
  return options.root_size / (1 << checked_levels(options));
}

}  // namespace

double shell_thickness(const ReconstructOptions& options) {
  return shell_thickness_voxels * voxel_side(options);
}

VoxelGrid make_shell_grid(const ReconstructOptions& options) {
  const double half = options.root_size / 2;
  const Box root{.min = {-half, -half, 0}, .max = {half, half, options.root_size}};
  return {options.root_size, checked_levels(options), root,
          truncation_voxels * voxel_side(options)};
}

bool make_shell(const CompactBrick& from, ShellBrick& shell) {
  bool any_near = false;
  for (std::size_t sample = 0; sample < shell.distance.size(); ++sample) {
    std::int16_t& to = shell.distance[sample];
    to = ShellBrick::not_observed;
    if (from.state(sample) == VoxelState::observed) {
      const int front = from.distance[sample];
      to = static_cast<std::int16_t>(
          std::max(front, -front - shell_thickness_voxels * shell_voxel_ticks));
      any_near = any_near || to <= shell_voxel_ticks;
    }
  }
  return any_near;
}

}  // namespace octurn
