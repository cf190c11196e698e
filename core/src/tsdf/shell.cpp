#include "tsdf/shell.hpp"

#include <algorithm>

#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

constexpr double truncation_voxels = VoxelGrid::ticks / shell_voxel_ticks;

double voxel_side(const ReconstructOptions& options) {
  return options.root_size / (1 << checked_levels(options));
}

std::size_t table_size(const Index3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
         static_cast<std::size_t>(size.z);
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

ShellField::ShellField(double root_side, double voxel_side, const Index3& low, const Index3& size)
    : root_side_(root_side),
      voxel_side_(voxel_side),
      low_(low),
      size_(size),
      table_(table_size(size)) {}

void ShellField::add(const Index3& position, const ShellBrick& brick) {
  const Index3 at{position.x - low_.x, position.y - low_.y, position.z - low_.z};
  bricks_.push_back(brick);
  table_[static_cast<std::size_t>((at.z * size_.y + at.y) * size_.x + at.x)] =
      static_cast<std::uint32_t>(bricks_.size());
}

float ShellField::half_voxel() const { return static_cast<float>(shell_voxel_ticks) / 2; }

const ShellBrick* ShellField::find(const Index3& brick) const {
  const Index3 at{brick.x - low_.x, brick.y - low_.y, brick.z - low_.z};
  if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) {
    return nullptr;
  }
  const std::uint32_t index =
      table_[static_cast<std::size_t>((at.z * size_.y + at.y) * size_.x + at.x)];
  return index == 0 ? nullptr : &bricks_[index - 1];
}

HoleFilledSdf::Value ShellField::at(const Index3& voxel) const {
  const ShellBrick* const brick = find({voxel.x >> 3, voxel.y >> 3, voxel.z >> 3});
  const std::int16_t distance =
      brick == nullptr ? ShellBrick::not_observed : brick->distance[VoxelGrid::sample_index(voxel)];
  return {.distance = static_cast<float>(distance),
          .observed = distance != ShellBrick::not_observed};
}

VoxelMask ShellField::inside(const Index3& low, const Index3& end) const {
  VoxelMask mask(low, end);
  for (int z = low.z; z < end.z; ++z) {
    for (int y = low.y; y < end.y; ++y) {
      const auto row = mask.row(y - low.y, z - low.z);
      for (int x = low.x; x < end.x;) {
        const int next = std::min((x >> 3) * brick_side + brick_side, end.x);
        if (find({x >> 3, y >> 3, z >> 3}) == nullptr) {
          x = next;
          continue;
        }
        for (; x < next; ++x) {
          const auto bit = static_cast<std::size_t>(x - low.x);
          row[bit / 64] |= std::uint64_t{at({x, y, z}).distance < 0 ? 1U : 0U} << bit % 64;
        }
      }
    }
  }
  return mask;
}

}  // namespace octurn
