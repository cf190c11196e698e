#include "octurn/distance_field.hpp"

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

DistanceField::DistanceField(double side, int levels, const Box& clip, double truncation,
                             std::size_t max_bytes)
    : side_(side),
      levels_(levels),
      leaf_side_(side / (1 << levels)),
      truncation_(truncation),
      max_bytes_(max_bytes),
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
  const auto count = static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                     static_cast<std::size_t>(size_.z);
  const auto a_brick = static_cast<std::size_t>(cells_a_brick());
  names_.resize(count);
  free_.resize(count * a_brick * a_brick * a_brick);
}

FieldBrick& DistanceField::make(const Cell& brick) {
  std::uint32_t& index = names_[name_of(brick)];
  if (index == 0) {
    if (bricks_.is_full() && bytes() + Pool<FieldBrick>::block_bytes > max_bytes_) {
      throw OctreeFull();
    }
    index = bricks_.add();
  }
  return bricks_[index];
}

}  // namespace octurn
