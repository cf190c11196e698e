#include "tsdf/tsdf_volume.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

// A cell is the grain of free space and of what is filled in: what a Kinect can tell apart.
constexpr double cell_side = 0.004;  // metres

int cell_leaves_of(double leaf_side) {
  int leaves = 2;
  while (leaves < Brick::side && leaves * leaf_side * 1.5 < cell_side) {
    leaves *= 2;
  }
  return leaves;
}

}  // namespace

VoxelGrid::VoxelGrid(double side, int levels, const Box& clip, double truncation)
    : side_(side),
      levels_(levels),
      leaf_side_(side / (1 << levels)),
      truncation_(truncation),
      cell_leaves_(cell_leaves_of(leaf_side_)) {
  const double brick_side = leaf_side_ * Brick::side;
  const auto bricks = [&](Eigen::Index axis) {
    const double corner = axis < 2 ? -side / 2 : 0.0;
    const int last = std::max((1 << levels) / Brick::side, 1) - 1;
    const auto brick_at = [&](double at) {
      return std::clamp(static_cast<int>(std::floor((at - corner) / brick_side)), 0, last);
    };
    // The model stands on the platform, wherever the clip box begins.
    const int first = axis == 2 ? 0 : brick_at(clip.min[axis]);
    return std::array{first - 1, brick_at(clip.max[axis]) - first + 3};
  };
  low_ = {bricks(0)[0], bricks(1)[0], bricks(2)[0]};
  size_ = {bricks(0)[1], bricks(1)[1], bricks(2)[1]};
}

Box VoxelGrid::box() const {
  const auto corner = [&](const Index3& brick) {
    const auto at = [&](int bricks, std::size_t axis) {
      return centre(bricks * Brick::side, axis) - leaf_side_ / 2;
    };
    return Eigen::Vector3d(at(brick.x, 0), at(brick.y, 1), at(brick.z, 2));
  };
  return {.min = corner(low_),
          .max = corner({low_.x + size_.x, low_.y + size_.y, low_.z + size_.z})};
}

TsdfVolume::TsdfVolume(const VoxelGrid& shape, std::size_t max_bytes)
    : VoxelGrid(shape),
      max_bytes_(max_bytes),
      layers_{.low = 0, .end = shape.size().z},
      bricks_(brick_count()),
      free_(cell_count()) {}

void TsdfVolume::begin(int low, std::size_t max_bytes) {
  max_bytes_ = max_bytes;
  layers_ = {.low = low, .end = size().z};
  bricks_.clear();
  std::ranges::fill(free_, std::uint8_t{0});
}

TsdfBrick* TsdfVolume::make(const Index3& brick) {
  const std::size_t place = brick_index(brick);
  TsdfBrick* const made = bricks_.find(place);
  if (made != nullptr) {
    return made;
  }
  while (brick.z < layers_.end && bricks_.is_full() &&
         bytes() + BlockPool<TsdfBrick>::block_bytes > max_bytes_) {
    drop_top_layers();
  }
  return brick.z < layers_.end ? &bricks_.add(place) : nullptr;
}

/// Gives up layers from the top, until at most half of the bricks are left, or one layer.
void TsdfVolume::drop_top_layers() {
  if (layers_.end - layers_.low <= 1) {
    throw OutOfBudget();
  }
  const auto for_each_in = [&](int z, auto visit) {
    for (std::size_t place = brick_index({0, 0, z}); place < brick_index({0, 0, z + 1}); ++place) {
      if (bricks_.find(place) != nullptr) {
        visit(place);
      }
    }
  };
  std::size_t all = 0;
  for (int z = layers_.low; z < layers_.end; ++z) {
    for_each_in(z, [&](std::size_t) { ++all; });
  }
  for (std::size_t kept = all; 2 * kept > all && layers_.end - layers_.low > 1;) {
    --layers_.end;
    for_each_in(layers_.end, [&](std::size_t place) {
      bricks_.remove(place);
      --kept;
    });
  }
}

}  // namespace octurn
