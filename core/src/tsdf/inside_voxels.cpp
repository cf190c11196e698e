// The signs of a field whose holes are filled.

#include <algorithm>
#include <utility>

#include "octurn/snapshot.hpp"
#include "tsdf/hole_filled_sdf.hpp"

namespace octurn {
namespace {

/// One bit for each voxel of a brick's row.
template <typename IsInside>
std::uint64_t row_bits(IsInside is_inside) {
  std::uint64_t bits = 0;
  for (int x = 0; x < brick_side; ++x) {
    bits |= (is_inside(x) ? std::uint64_t{1} : 0) << x;
  }
  return bits;
}

/// Clears the sides and the top of a mask.
void clear_border(VoxelMask& mask) {
  const Index3& size = mask.size();
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      const auto row = mask.row(y, z);
      if (y == 0 || y + 1 == size.y || z + 1 == size.z) {
        std::ranges::fill(row, 0U);
      }
      row.front() &= ~std::uint64_t{1};
      row[static_cast<std::size_t>(size.x - 1) / 64] &= ~(std::uint64_t{1} << (size.x - 1) % 64);
    }
  }
}

}  // namespace

/// The side of the surface that a whole brick lies on; `both` if its blocks and their neighbours
/// differ in sign, or if it has samples of its own.
/// @param brick  counted from the box's lowest corner
HoleFilledSdf::Side HoleFilledSdf::to_side(const Index3& brick) const {
  const int per_brick = grid().blocks_per_brick();
  const Index3 first{brick.x * per_brick, brick.y * per_brick, brick.z * per_brick};
  const Index3 in_grid{low_brick_.x + brick.x, low_brick_.y + brick.y, low_brick_.z + brick.z};
  const Place place = to_place(
      {low_.x + brick.x * brick_side, low_.y + brick.y * brick_side, low_.z + brick.z * brick_side},
      {brick_side, brick_side, brick_side});
  if (place == Place::below) {
    return Side::outside;
  }
  if (known_.find(in_grid) != nullptr || brick.z == 0 || place == Place::near) {
    return Side::both;
  }
  bool any_inside = false;
  bool any_outside = false;
  const auto around = [&](int at, int size) {
    return std::pair(std::max(at - 1, 0), std::min(at + per_brick, size - 1));
  };
  const auto [x0, x1] = around(first.x, blocks_.size.x);
  const auto [y0, y1] = around(first.y, blocks_.size.y);
  const auto [z0, z1] = around(first.z, blocks_.size.z);
  for (int z = z0; z <= z1; ++z) {
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        (blocks_.values[blocks_.index(x, y, z)] < 0 ? any_inside : any_outside) = true;
      }
    }
  }
  if (any_inside && any_outside) {
    return Side::both;
  }
  // A free block is outside, whatever is around it.
  return any_outside ? Side::outside : Side::inside;
}

/// The signs of eight voxels of a brick's row, `first` the first of them: 1 where the distance is
/// negative.
std::uint64_t HoleFilledSdf::inside_bits(const Index3& first) const {
  const Place place = to_place(first, {brick_side, 1, 1});
  if (place == Place::below) {
    return 0;
  }
  if (first.z < base_layer_ || place == Place::near) {
    return row_bits([&](int x) { return at({first.x + x, first.y, first.z}).distance < 0; });
  }
  const CompactBrick* const brick = brick_at(first);
  return row_bits([&](int x) {
    const Index3 voxel{first.x + x, first.y, first.z};
    switch (state_at(voxel, brick)) {
      case VoxelState::observed:
        return brick->distance[VoxelGrid::sample_index(voxel)] < 0;
      case VoxelState::free:
        return false;
      default:
        return filled_at(voxel) < 0;
    }
  });
}

/// Adds the voxels inside of a brick that is counted from the box's lowest corner.
void HoleFilledSdf::add_inside(const Index3& brick, VoxelMask& mask) const {
  const Side side = to_side(brick);
  if (side == Side::outside) {
    return;
  }
  for (int z = brick.z * brick_side; z < (brick.z + 1) * brick_side; ++z) {
    for (int y = brick.y * brick_side; y < (brick.y + 1) * brick_side; ++y) {
      const std::uint64_t bits =
          side == Side::inside
              ? 0xff
              : inside_bits({low_.x + brick.x * brick_side, low_.y + y, low_.z + z});
      mask.row(y, z)[static_cast<std::size_t>(brick.x) / 8] |= bits << (brick.x % 8 * brick_side);
    }
  }
}

VoxelMask HoleFilledSdf::inside(const std::stop_token& stop, ThreadTeam& team) const {
  VoxelMask mask(low_, end_);
  const Index3& size = mask.size();
  const int rows = size.y / brick_side;  // of bricks, in a layer
  team.for_each(size.z / brick_side * rows, [&](int row) {
    throw_if_stopped(stop);
    for (int x = 0; x < size.x / brick_side; ++x) {
      add_inside({x, row % rows, row / rows}, mask);
    }
  });
  clear_border(mask);
  if (!platforms_.empty() && size.z > 0) {  // the lowest layer must be outside
    for (int y = 0; y < size.y; ++y) {
      std::ranges::fill(mask.row(y, 0), 0U);
    }
  }
  return mask;
}

}  // namespace octurn
