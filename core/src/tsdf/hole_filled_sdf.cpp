#include "tsdf/hole_filled_sdf.hpp"

#include <algorithm>
#include <cmath>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

// The distance of free space where the unknown is filled in. Less would leave more of what no
// snapshot saw to the model.
constexpr float free_distance = 0.8F * VoxelGrid::ticks;

std::size_t sample_of(const Index3& leaf) {
  return static_cast<std::size_t>((leaf.x & 7) | (leaf.y & 7) << 3 | (leaf.z & 7) << 6);
}

/// A bit for each of the leaves of a brick's row.
template <typename IsInside>
std::uint64_t bits_of(IsInside is_inside) {
  std::uint64_t bits = 0;
  for (int x = 0; x < Brick::side; ++x) {
    bits |= (is_inside(x) ? std::uint64_t{1} : 0) << x;
  }
  return bits;
}

constexpr int sweeps = 10;  // over each grid of the harmonic fill, there and back

}  // namespace

HoleFilledSdf::HoleFilledSdf(const CompactTsdf& field, int foot, const std::stop_token& stop)
    : field_(field), base_layer_(foot) {
  find_box();
  classify(stop);
  solve_laplace(grid_, stop);
}

void HoleFilledSdf::find_box() {
  const Index3& size = field_.size();
  Index3 first = size;
  Index3 last{-1, -1, -1};
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        if (field_.find({x, y, z}) != nullptr) {
          first = {std::min(first.x, x), std::min(first.y, y), std::min(first.z, z)};
          last = {std::max(last.x, x), std::max(last.y, y), std::max(last.z, z)};
        }
      }
    }
  }
  if (last.x < 0) {
    return;
  }
  // One brick around what was seen; the first layer of bricks is below the platform.
  first = {first.x - 1, first.y - 1, 1};
  last = {last.x + 1, last.y + 1, std::min(last.z + 1, size.z - 1)};
  const auto leaf = [](int brick, int low) { return (brick + low) * Brick::side; };
  low_ = {leaf(first.x, field_.low().x), leaf(first.y, field_.low().y),
          leaf(first.z, field_.low().z)};
  end_ = {leaf(last.x + 1, field_.low().x), leaf(last.y + 1, field_.low().y),
          leaf(last.z + 1, field_.low().z)};
  const int per_brick = field_.blocks_per_brick();
  low_cell_ = {first.x * per_brick, first.y * per_brick, first.z * per_brick};
  grid_.size = {(last.x + 1 - first.x) * per_brick, (last.y + 1 - first.y) * per_brick,
                (last.z + 1 - first.z) * per_brick};
  lerp_weights_ = {lerp_weights(end_.x - low_.x, grid_.size.x),
                   lerp_weights(end_.y - low_.y, grid_.size.y),
                   lerp_weights(std::max(end_.z, base_layer_ + 1) - low_.z, grid_.size.z)};
}

void HoleFilledSdf::classify(const std::stop_token& stop) {
  const auto count = grid_.index(0, 0, grid_.size.z);
  grid_.values.resize(count);
  grid_.known.resize(count);
  std::size_t index = 0;
  for (int z = 0; z < grid_.size.z; ++z) {
    throw_if_stopped(stop);
    for (int y = 0; y < grid_.size.y; ++y) {
      for (int x = 0; x < grid_.size.x; ++x, ++index) {
        classify({low_cell_.x + x, low_cell_.y + y, low_cell_.z + z}, index);
      }
    }
  }
}

void HoleFilledSdf::classify(const Index3& cell, std::size_t index) {
  const int per_brick = field_.blocks_per_brick();
  const int leaves = field_.block_voxels();
  const Index3 position{cell.x / per_brick, cell.y / per_brick, cell.z / per_brick};
  if (field_.is_border(position)) {
    grid_.values[index] = free_distance;
    grid_.known[index] = 1;
    return;
  }
  const CompactBrick* const brick = field_.find(position);
  if (brick == nullptr && field_.is_free(cell)) {
    grid_.values[index] = free_distance;
    grid_.known[index] = 1;
  } else if (brick != nullptr) {
    const RunningMean tally = mean_known_distance(*brick, position, cell);
    if (tally.known * 4 >= leaves * leaves * leaves) {
      grid_.values[index] = tally.sum / static_cast<float>(tally.known);
      grid_.known[index] = 1;
    }
  }
}

/// What is known of a cell's samples. Behind a surface even the faintest sample says that there is
/// something to fill.
HoleFilledSdf::RunningMean HoleFilledSdf::mean_known_distance(const CompactBrick& brick,
                                                              const Index3& position,
                                                              const Index3& cell) const {
  const int per_brick = field_.blocks_per_brick();
  const int leaves = field_.block_voxels();
  RunningMean tally;
  for (int z = 0; z < leaves; ++z) {
    const int bz = cell.z % per_brick * leaves + z;
    if ((position.z + field_.low().z) * Brick::side + bz < base_layer_) {
      continue;
    }
    for (int y = 0; y < leaves; ++y) {
      for (int x = 0; x < leaves; ++x) {
        const auto sample = static_cast<std::size_t>(
            cell.x % per_brick * leaves + x + (cell.y % per_brick * leaves + y) * Brick::side +
            bz * Brick::side * Brick::side);
        switch (brick.at(sample)) {
          case VoxelState::seen:
          case VoxelState::behind:
            tally.add(std::min(static_cast<float>(brick.distance[sample]), free_distance));
            break;
          case VoxelState::free:
            tally.add(free_distance);
            break;
          case VoxelState::unknown:
            break;
        }
      }
    }
  }
  return tally;
}

/// Solves Laplace's equation for the unknown, from coarse to fine: each grid gives the next finer
/// one its first guess. A coarse cell is as the innermost of its cells, so that a thin shell stays
/// closed.
void HoleFilledSdf::solve_laplace(Grid& fine, const std::stop_token& stop) {
  if (fine.values.size() < 2 || std::ranges::all_of(fine.known, [](char k) { return k != 0; })) {
    return;
  }
  Grid coarse{.size = {(fine.size.x + 1) / 2, (fine.size.y + 1) / 2, (fine.size.z + 1) / 2},
              .values = {},
              .known = {}};
  const auto count = coarse.index(0, 0, coarse.size.z);
  coarse.values.resize(count);
  coarse.known.resize(count);
  const auto for_each = [&](auto visit) {
    std::size_t index = 0;
    for (int z = 0; z < fine.size.z; ++z) {
      throw_if_stopped(stop);
      for (int y = 0; y < fine.size.y; ++y) {
        for (int x = 0; x < fine.size.x; ++x, ++index) {
          visit(index, coarse.index(x / 2, y / 2, z / 2));
        }
      }
    }
  };
  for_each([&](std::size_t from, std::size_t to) {
    if (fine.known[from] != 0) {
      const float value = fine.values[from];
      coarse.values[to] = coarse.known[to] != 0 ? std::min(coarse.values[to], value) : value;
      coarse.known[to] = 1;
    }
  });
  solve_laplace(coarse, stop);
  for_each([&](std::size_t to, std::size_t from) {
    if (fine.known[to] == 0) {
      fine.values[to] = coarse.values[from];
    }
  });
  gauss_seidel_sweep(fine, stop);
}

/// Makes an unknown value the mean of those around it; at the box's sides the value beyond is that
/// within.
void HoleFilledSdf::gauss_seidel_sweep(Grid& grid, int x, int y, int z) {
  const std::size_t i = grid.index(x, y, z);
  if (grid.known[i] != 0) {
    return;
  }
  const Index3& size = grid.size;
  std::vector<float>& values = grid.values;
  const float sum = values[x > 0 ? i - 1 : i] + values[x + 1 < size.x ? i + 1 : i] +
                    values[y > 0 ? grid.index(x, y - 1, z) : i] +
                    values[y + 1 < size.y ? grid.index(x, y + 1, z) : i] +
                    values[z > 0 ? grid.index(x, y, z - 1) : i] +
                    values[z + 1 < size.z ? grid.index(x, y, z + 1) : i];
  values[i] = sum / 6;
}

/// Gauss-Seidel sweeps of Laplace's equation, there and back.
void HoleFilledSdf::gauss_seidel_sweep(Grid& grid, const std::stop_token& stop) {
  const Index3& size = grid.size;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int z = 0; z < size.z; ++z) {
      throw_if_stopped(stop);
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
          gauss_seidel_sweep(grid, x, y, z);
        }
      }
    }
    for (int z = size.z - 1; z >= 0; --z) {
      throw_if_stopped(stop);
      for (int y = size.y - 1; y >= 0; --y) {
        for (int x = size.x - 1; x >= 0; --x) {
          gauss_seidel_sweep(grid, x, y, z);
        }
      }
    }
  }
}

/// Where the leaves of the box lie between the centres of cells on an axis.
std::vector<HoleFilledSdf::LerpWeight> HoleFilledSdf::lerp_weights(int leaves, int cells) const {
  std::vector<LerpWeight> all;
  for (int leaf = 0; leaf < leaves; ++leaf) {
    const float at =
        (static_cast<float>(leaf) + 0.5F) / static_cast<float>(field_.block_voxels()) - 0.5F;
    const int first = std::clamp(static_cast<int>(std::max(at, 0.0F)), 0, cells - 2);
    all.push_back({first, std::clamp(at - static_cast<float>(first), 0.0F, 1.0F)});
  }
  return all;
}

float HoleFilledSdf::interpolated(const LerpWeight& x, const LerpWeight& y,
                                  const LerpWeight& z) const {
  const auto mix = [](float a, float b, float part) { return a + (b - a) * part; };
  const auto row = [&](int dy, int dz) {
    const float* pair = &grid_.values[grid_.index(x.first, y.first + dy, z.first + dz)];
    return mix(pair[0], pair[1], x.part);
  };
  return mix(mix(row(0, 0), row(1, 0), y.part), mix(row(0, 1), row(1, 1), y.part), z.part);
}

float HoleFilledSdf::interpolated(const Index3& leaf) const {
  const auto between = [&](std::size_t axis, int from_low) -> const LerpWeight& {
    return lerp_weights_[axis][static_cast<std::size_t>(from_low)];
  };
  return interpolated(between(0, leaf.x - low_.x), between(1, leaf.y - low_.y),
                      between(2, leaf.z - low_.z));
}

/// What is known of a leaf. @param brick  that it lies in, if there is one
VoxelState HoleFilledSdf::sighted(const Index3& leaf, const CompactBrick* brick) const {
  if (brick != nullptr) {
    return brick->at(sample_of(leaf));
  }
  const Index3& low = field_.low();
  const int per_brick = field_.blocks_per_brick();
  const int leaves = field_.block_voxels();
  const bool is_free =
      field_.is_free({leaf.x / leaves - low.x * per_brick, leaf.y / leaves - low.y * per_brick,
                      leaf.z / leaves - low.z * per_brick});
  return is_free ? VoxelState::free : VoxelState::unknown;
}

const CompactBrick* HoleFilledSdf::brick_at(const Index3& leaf) const {
  const Index3& low = field_.low();
  return field_.find({(leaf.x >> 3) - low.x, (leaf.y >> 3) - low.y, (leaf.z >> 3) - low.z});
}

HoleFilledSdf::Value HoleFilledSdf::at(const Index3& leaf) const {
  const Index3 above{leaf.x, leaf.y, std::max(leaf.z, base_layer_)};
  const CompactBrick* const brick = brick_at(above);
  const VoxelState sighted = this->sighted(above, brick);
  Value value;
  if (sighted == VoxelState::seen) {
    value.distance = static_cast<float>(brick->distance[sample_of(above)]);
    value.seen = true;
  } else if (sighted == VoxelState::free) {
    value.distance = VoxelGrid::ticks;
  } else {
    value.distance = interpolated(above);
  }
  // The model is what lies above the platform.
  const auto below = static_cast<float>(-(leaf.z + 0.5) * field_.leaf_side() / field_.truncation() *
                                        VoxelGrid::ticks);
  if (below > value.distance) {
    value = {below, false};
  }
  return value;
}

/// The side of the surface that a brick, counted from the box's lowest corner, lies on, as far as
/// its cells and those around it tell.
HoleFilledSdf::Side HoleFilledSdf::side_of(const Index3& brick) const {
  const int per_brick = field_.blocks_per_brick();
  const Index3 first{brick.x * per_brick, brick.y * per_brick, brick.z * per_brick};
  const Index3 in_field{low_cell_.x / per_brick + brick.x, low_cell_.y / per_brick + brick.y,
                        low_cell_.z / per_brick + brick.z};
  if (field_.find(in_field) != nullptr || brick.z == 0) {
    return Side::both;
  }
  bool any_inside = false;
  bool any_outside = false;
  const auto around = [&](int at, int size) {
    return std::pair(std::max(at - 1, 0), std::min(at + per_brick, size - 1));
  };
  const auto [x0, x1] = around(first.x, grid_.size.x);
  const auto [y0, y1] = around(first.y, grid_.size.y);
  const auto [z0, z1] = around(first.z, grid_.size.z);
  for (int z = z0; z <= z1; ++z) {
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        (grid_.values[grid_.index(x, y, z)] < 0 ? any_inside : any_outside) = true;
      }
    }
  }
  if (any_inside && any_outside) {
    return Side::both;
  }
  // A cell that was seen through is outside, whatever is around it.
  return any_outside ? Side::outside : Side::inside;
}

/// Eight leaves of a row that lie in one brick, `first` the first of them: a bit for each at which
/// the distance is negative.
std::uint64_t HoleFilledSdf::inside(const Index3& first) const {
  if (first.z < base_layer_) {
    return bits_of([&](int x) { return at({first.x + x, first.y, first.z}).distance < 0; });
  }
  const CompactBrick* const brick = brick_at(first);
  return bits_of([&](int x) {
    const Index3 leaf{first.x + x, first.y, first.z};
    switch (sighted(leaf, brick)) {
      case VoxelState::seen:
        return brick->distance[sample_of(leaf)] < 0;
      case VoxelState::free:
        return false;
      default:
        return interpolated(leaf) < 0;
    }
  });
}

/// Adds the leaves of a brick, counted from the box's lowest corner, that lie inside.
void HoleFilledSdf::add_inside(const Index3& brick, VoxelMask& set) const {
  const Side side = side_of(brick);
  if (side == Side::outside) {
    return;
  }
  for (int z = brick.z * Brick::side; z < (brick.z + 1) * Brick::side; ++z) {
    for (int y = brick.y * Brick::side; y < (brick.y + 1) * Brick::side; ++y) {
      const std::uint64_t bits =
          side == Side::inside ? 0xff
                               : inside({low_.x + brick.x * Brick::side, low_.y + y, low_.z + z});
      set.row(y, z)[static_cast<std::size_t>(brick.x) / 8] |= bits << (brick.x % 8 * Brick::side);
    }
  }
}

VoxelMask HoleFilledSdf::inside(const std::stop_token& stop) const {
  VoxelMask set(low_, end_);
  const Index3& size = set.size();
  for (int z = 0; z < size.z / Brick::side; ++z) {
    throw_if_stopped(stop);
    for (int y = 0; y < size.y / Brick::side; ++y) {
      for (int x = 0; x < size.x / Brick::side; ++x) {
        add_inside({x, y, z}, set);
      }
    }
  }
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      const auto row = set.row(y, z);
      if (y == 0 || y + 1 == size.y || z + 1 == size.z) {
        std::ranges::fill(row, 0U);
      }
      row.front() &= ~std::uint64_t{1};
      row[static_cast<std::size_t>(size.x - 1) / 64] &= ~(std::uint64_t{1} << (size.x - 1) % 64);
    }
  }
  return set;
}

}  // namespace octurn
