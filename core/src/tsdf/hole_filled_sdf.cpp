#include "tsdf/hole_filled_sdf.hpp"

#include <algorithm>
#include <utility>

#include "octurn/snapshot.hpp"
#include "tsdf/known_blocks.hpp"

namespace octurn {
namespace {

// An observed surface is cut only this far below the platform of another pose, because poses are
// accurate to some tenths of a millimetre.
constexpr double observed_slack = 0.001;  // metres

// Up to this height above its platform a pose hardly observes the object: readings there mix the
// object's foot with the platform.
constexpr double unseen_foot = 0.004;  // metres

}  // namespace

HoleFilledSdf::HoleFilledSdf(const CompactTsdf& known, int base_layer, const std::stop_token& stop,
                             ThreadTeam& team, std::optional<double> max_bulge)
    : known_(known), base_layer_(base_layer) {
  fill(max_bulge, stop, team);
}

HoleFilledSdf::HoleFilledSdf(const CompactTsdf& known, std::vector<PlatformCut> platforms,
                             const std::stop_token& stop, ThreadTeam& team,
                             std::optional<double> max_bulge)
    : known_(known),
      base_layer_(known.grid().low().z * brick_side),
      platforms_(std::move(platforms)) {
  fill(max_bulge, stop, team);
}

void HoleFilledSdf::fill(std::optional<double> max_bulge, const std::stop_token& stop,
                         ThreadTeam& team) {
  KnownBlocks blocks = known_blocks(known_, base_layer_, platforms_, stop, team);
  if (blocks.distances.values.empty()) {
    return;
  }
  if (max_bulge) {
    limit_bulges(blocks, grid(), *max_bulge);
  }
  const Index3& low = grid().low();
  const auto voxel = [](int brick, int lowest) { return (brick + lowest) * brick_side; };
  low_brick_ = blocks.low;
  low_ = {voxel(blocks.low.x, low.x), voxel(blocks.low.y, low.y), voxel(blocks.low.z, low.z)};
  end_ = {voxel(blocks.end.x, low.x), voxel(blocks.end.y, low.y), voxel(blocks.end.z, low.z)};
  blocks_ = laplace_fill(std::move(blocks.distances), stop, team);
  lerp_weights_ = {lerp_weights(end_.x - low_.x, blocks_.size.x),
                   lerp_weights(end_.y - low_.y, blocks_.size.y),
                   lerp_weights(std::max(end_.z, base_layer_ + 1) - low_.z, blocks_.size.z)};
}

/// Where the centres of voxels lie between the centres of blocks on an axis.
std::vector<HoleFilledSdf::LerpWeight> HoleFilledSdf::lerp_weights(int voxels, int blocks) const {
  std::vector<LerpWeight> weights;
  for (int voxel = 0; voxel < voxels; ++voxel) {
    const float at =
        (static_cast<float>(voxel) + 0.5F) / static_cast<float>(grid().block_voxels()) - 0.5F;
    const int first = std::clamp(static_cast<int>(std::max(at, 0.0F)), 0, blocks - 2);
    weights.push_back({first, std::clamp(at - static_cast<float>(first), 0.0F, 1.0F)});
  }
  return weights;
}

float HoleFilledSdf::trilinear(const LerpWeight& x, const LerpWeight& y,
                               const LerpWeight& z) const {
  const auto lerp = [](float a, float b, float part) { return a + (b - a) * part; };
  const auto row = [&](int dy, int dz) {
    const float* pair = &blocks_.values[blocks_.index(x.first, y.first + dy, z.first + dz)];
    return lerp(pair[0], pair[1], x.part);
  };
  return lerp(lerp(row(0, 0), row(1, 0), y.part), lerp(row(0, 1), row(1, 1), y.part), z.part);
}

float HoleFilledSdf::filled_at(const Index3& voxel) const {
  const auto weight = [&](std::size_t axis, int from_low) -> const LerpWeight& {
    return lerp_weights_[axis][static_cast<std::size_t>(from_low)];
  };
  return trilinear(weight(0, voxel.x - low_.x), weight(1, voxel.y - low_.y),
                   weight(2, voxel.z - low_.z));
}

/// @param brick  that holds the voxel, or null
VoxelState HoleFilledSdf::state_at(const Index3& voxel, const CompactBrick* brick) const {
  if (brick != nullptr) {
    return brick->state(VoxelGrid::sample_index(voxel));
  }
  const Index3& low = grid().low();
  const int per_brick = grid().blocks_per_brick();
  const int voxels = grid().block_voxels();
  const bool is_free =
      known_.is_free({voxel.x / voxels - low.x * per_brick, voxel.y / voxels - low.y * per_brick,
                      voxel.z / voxels - low.z * per_brick});
  return is_free ? VoxelState::free : VoxelState::unknown;
}

const CompactBrick* HoleFilledSdf::brick_at(const Index3& voxel) const {
  const Index3& low = grid().low();
  return known_.find({(voxel.x >> 3) - low.x, (voxel.y >> 3) - low.y, (voxel.z >> 3) - low.z});
}

/// The value of a voxel before any cut at a platform.
HoleFilledSdf::Value HoleFilledSdf::sample(const Index3& voxel) const {
  const CompactBrick* const brick = brick_at(voxel);
  switch (state_at(voxel, brick)) {
    case VoxelState::observed:
      return {static_cast<float>(brick->distance[VoxelGrid::sample_index(voxel)]), true};
    case VoxelState::free:
      return {VoxelGrid::ticks, false};
    default:
      return {filled_at(voxel), false};
  }
}

bool HoleFilledSdf::is_seen_empty(const Index3& voxel) const {
  const Value value = sample({voxel.x, voxel.y, std::max(voxel.z, base_layer_)});
  return value.distance >= VoxelGrid::ticks || (value.observed && value.distance > 0);
}

HoleFilledSdf::Value HoleFilledSdf::at(const Index3& voxel) const {
  Value value = sample({voxel.x, voxel.y, std::max(voxel.z, base_layer_)});
  if (!platforms_.empty()) {
    return cut_by_platforms(voxel, fill_foot(voxel, value));
  }
  // The intersection with the half-space above the platform.
  const auto below = static_cast<float>(-(voxel.z + 0.5) * grid().voxel_side() /
                                        grid().truncation() * VoxelGrid::ticks);
  if (below > value.distance) {
    value = {below, false};
  }
  return value;
}

float HoleFilledSdf::ticks(double metres) const {
  return static_cast<float>(metres / grid().truncation() * VoxelGrid::ticks);
}

/// Continues an unobserved foot straight down: a voxel right above a platform that no pose observed
/// takes the value above the unobserved layer.
HoleFilledSdf::Value HoleFilledSdf::fill_foot(const Index3& voxel, Value value) const {
  if (value.observed || state_at(voxel, brick_at(voxel)) == VoxelState::free) {
    return value;
  }
  for (const PlatformCut& platform : platforms_) {
    if (platform.height(voxel) >= ticks(unseen_foot)) {
      continue;
    }
    const Index3 above = platform.raised(voxel, ticks(unseen_foot));
    const bool is_here = above.x >= low_.x && above.y >= low_.y && above.z >= low_.z &&
                         above.x < end_.x && above.y < end_.y && above.z < end_.z;
    if (is_here) {
      return {sample(above).distance, false};
    }
  }
  return value;
}

/// The intersection with the half-spaces above the platforms of several poses. Observed voxels are
/// cut only well below them, so that the base is flat only where nothing was observed.
HoleFilledSdf::Value HoleFilledSdf::cut_by_platforms(const Index3& voxel, Value value) const {
  const float slack = ticks(observed_slack);
  for (const PlatformCut& platform : platforms_) {
    const float below = -platform.height(voxel) - (value.observed ? slack : 0.0F);
    if (below > value.distance) {
      value = {below, false};
    }
  }
  return value;
}

/// The position of a whole box of voxels relative to the platforms. Nothing below a platform is
/// inside.
HoleFilledSdf::Place HoleFilledSdf::to_place(const Index3& low, const Index3& size) const {
  Place place = Place::above;
  for (const PlatformCut& platform : platforms_) {
    const auto [lowest, highest] = platform.heights(low, size);
    if (highest < -ticks(observed_slack) - 1) {
      return Place::below;
    }
    place = lowest < ticks(unseen_foot) ? Place::near : place;
  }
  return place;
}

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
