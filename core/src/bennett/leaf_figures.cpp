#include "bennett/leaf_figures.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "bennett/marching_tetrahedra.hpp"
#include "mesh/hash.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::uint64_t first_column = 0x0101010101010101;
constexpr std::uint64_t first_row = 0xff;
constexpr double max_cell_side = 0.004;  // metres, the smallest cell of `SurfaceCells`

/// Bits 0, 8, .., 56 of a layer of leaves, those with x = 0, as one byte.
std::uint64_t to_column(std::uint64_t layer) {
  return (layer & first_column) * 0x0102040810204080 >> 56;
}

std::uint64_t to_row(std::uint64_t layer) { return layer & first_row; }

/// The 9 x 9 corners on one side of a brick of pseudo-voxels: 8 x 8 of one brick of leaves, and
/// those of its three neighbours.
struct SideCorners {
  std::uint64_t inner = 0;
  std::uint64_t rim = 0;  // 8 and 8 corners, and the one across

  bool is_crossed() const {
    constexpr std::uint64_t whole_rim = (1U << 17U) - 1;
    return (inner != 0 || rim != 0) && (~inner != 0 || rim != whole_rim);
  }
};

/// The side across z, of the four bricks above it.
SideCorners side_across_z(const Brick& here, const Brick& right, const Brick& behind,
                          const Brick& across) {
  return {.inner = here.layers[0],
          .rim = to_column(right.layers[0]) | to_row(behind.layers[0]) << 8 |
                 (across.layers[0] & 1) << 16};
}

/// The side across x or y.
/// @param strip   the leaves of a layer that touch the side: `to_column` across x, `to_row` across
/// y
/// @param beside  the brick beside along the side
template <typename Strip>
SideCorners upright_side(const Brick& here, const Brick& beside, const Brick& above,
                         const Brick& across, Strip strip) {
  SideCorners side{.rim = strip(above.layers[0]) | (across.layers[0] & 1) << 16};
  for (std::size_t z = 0; z < Brick::side; ++z) {
    side.inner |= strip(here.layers[z]) << (8 * z);
    side.rim |= (beside.layers[z] & 1) << (8 + z);
  }
  return side;
}

/// @param axis  that the side is across
/// @param at    position of the brick above it along that axis
std::uint64_t hash_of(const SideCorners& side, std::uint64_t axis, const Index3& at) {
  if (!side.is_crossed()) {
    return 0;
  }
  constexpr int bits = 20;  // of a brick's position, which may be -1
  const auto key = [](int position) { return static_cast<std::uint64_t>(position + 1); };
  const std::uint64_t place =
      axis << 3 * bits | key(at.x) << 2 * bits | key(at.y) << bits | key(at.z);
  return mix_bits(side.inner + mix_bits(side.rim + mix_bits(place + 1)));
}

}  // namespace

LeafFigures::LeafFigures(const Octree& octree)
    : low_xy_(-octree.side() / 2), leaf_side_(octree.leaf_side()), cell_leaves_(1) {
  while (cell_leaves_ < Brick::side && 2 * cell_leaves_ * leaf_side_ <= max_cell_side) {
    cell_leaves_ *= 2;
  }
  min_.fill(std::numeric_limits<int>::max());
  end_.fill(std::numeric_limits<int>::lowest());
}

void LeafFigures::add(const Octree& octree, const BrickLayers& slab) {
  leaves_ += octree.leaf_count(slab.low, slab.end);
  for (int layer = slab.low; layer < slab.end; ++layer) {
    octree.for_each_brick(layer, [&](const Index3& position, const Brick& brick) {
      add_leaves(position, brick);
      add_cells(position, brick);
      add_sample(position, brick);
    });
  }
  for (int layer = first_layer(slab); layer < slab.end; ++layer) {
    const PseudoVoxelLayer bricks = pseudo_voxels(octree, layer);
    for (const PseudoVoxelBrick& brick : bricks.bricks()) {
      add_sides(brick);
      for_each_mixed(brick, [&](int, int, int, std::size_t pattern) {
        excess_ += marching_tetrahedra_cases[pattern].excess;
      });
    }
  }
}

/// Extends the bounds by a brick's leaves.
void LeafFigures::add_leaves(const Index3& position, const Brick& brick) {
  std::uint64_t any = 0;
  std::uint64_t layers = 0;  // a bit for each that has leaves
  for (std::size_t z = 0; z < Brick::side; ++z) {
    any |= brick.layers[z];
    layers |= std::uint64_t{brick.layers[z] != 0} << z;
  }
  if (any == 0) {
    return;
  }
  std::uint64_t columns = any | any >> 32;
  columns |= columns >> 16;
  columns |= columns >> 8;
  std::uint64_t rows = any | any >> 4;  // to each row's first bit
  rows |= rows >> 2;
  rows |= rows >> 1;
  const std::array<std::uint64_t, 3> leaves{columns & 0xff, to_column(rows), layers};
  const std::array<int, 3> first{position.x, position.y, position.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int low = Brick::side * first[axis];
    min_[axis] = std::min(min_[axis], low + std::countr_zero(leaves[axis]));
    end_[axis] = std::max(end_[axis], low + 64 - std::countl_zero(leaves[axis]));
  }
}

/// Adds the middles of blocks of leaves to the cells of the surface.
void LeafFigures::add_cells(const Index3& position, const Brick& brick) {
  const int side = cell_leaves_;
  const std::uint64_t row = (1U << static_cast<unsigned>(side)) - 1;
  std::uint64_t block = 0;
  for (int y = 0; y < side; ++y) {
    block |= row << (Brick::side * y);
  }
  const Eigen::Vector3d low(low_xy_, low_xy_, 0);
  for (int z = 0; z < Brick::side; z += side) {
    std::uint64_t any = 0;
    for (int layer = z; layer < z + side; ++layer) {
      any |= brick.layers[static_cast<std::size_t>(layer)];
    }
    for (int y = 0; any != 0 && y < Brick::side; y += side) {
      for (int x = 0; x < Brick::side; x += side) {
        if ((any & block << (Brick::side * y + x)) != 0) {
          const Eigen::Vector3d first(Brick::side * position.x + x, Brick::side * position.y + y,
                                      Brick::side * position.z + z);
          surface_.add(low + leaf_side_ * (first + Eigen::Vector3d::Constant(side / 2.0)));
        }
      }
    }
  }
}

/// Adds a brick's leaves whose number is a multiple of the step.
void LeafFigures::add_sample(const Index3& position, const Brick& brick) {
  for (std::size_t z = 0; z < Brick::side; ++z) {
    const std::uint64_t first = passed_;
    passed_ += static_cast<std::uint64_t>(std::popcount(brick.layers[z]));
    const std::uint64_t next = (first + sample_step_ - 1) / sample_step_ * sample_step_;
    std::uint64_t leaves = next < passed_ ? brick.layers[z] : 0;
    for (std::uint64_t number = first; leaves != 0; ++number, leaves &= leaves - 1) {
      if (number % sample_step_ == 0) {
        const int bit = std::countr_zero(leaves);
        sample_.push_back({.x = Brick::side * position.x + bit % Brick::side,
                           .y = Brick::side * position.y + bit / Brick::side,
                           .z = Brick::side * position.z + static_cast<int>(z)});
      }
      if (sample_.size() > max_sample) {  // keeps every other one, the first among them
        std::size_t kept = 0;
        for (std::size_t i = 0; i < sample_.size(); i += 2) {
          sample_[kept++] = sample_[i];
        }
        sample_.resize(kept);
        sample_step_ *= 2;
      }
    }
  }
}

std::vector<Eigen::Vector3d> LeafFigures::sample() const {
  const Eigen::Vector3d low(low_xy_, low_xy_, 0);
  std::vector<Eigen::Vector3d> middles;
  for (const Index3& leaf : sample_) {
    middles.push_back(low + leaf_side_ * Eigen::Vector3d(leaf.x + 0.5, leaf.y + 0.5, leaf.z + 0.5));
  }
  return middles;
}

void LeafFigures::add_sides(const PseudoVoxelBrick& brick) {
  const auto& [x, y, z] = brick.position;
  const auto at = [&](std::size_t i) -> const Brick& { return *brick.bricks[i]; };
  sides_ += hash_of(upright_side(at(0), at(2), at(4), at(6), to_column), 0, {x, y, z}) -
            hash_of(upright_side(at(1), at(3), at(5), at(7), to_column), 0, {x + 1, y, z}) +
            hash_of(upright_side(at(0), at(1), at(4), at(5), to_row), 1, {x, y, z}) -
            hash_of(upright_side(at(2), at(3), at(6), at(7), to_row), 1, {x, y + 1, z}) +
            hash_of(side_across_z(at(0), at(1), at(2), at(3)), 2, {x, y, z}) -
            hash_of(side_across_z(at(4), at(5), at(6), at(7)), 2, {x, y, z + 1});
}

double LeafFigures::volume() const {
  constexpr double eighths = 6 * 8;  // of the tetrahedra of a pseudo-voxel
  return (static_cast<double>(leaves_) + static_cast<double>(excess_) / eighths) * leaf_side_ *
         leaf_side_ * leaf_side_;
}

Box LeafFigures::bounds() const {
  Box bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = axis < 2 ? low_xy_ : 0;
    const auto rounded = [&](int leaf) {
      const auto mm = static_cast<float>(mm_from_metres(low + 2.0 * leaf * (leaf_side_ / 2)));
      return metres_from_mm(static_cast<double>(mm));
    };
    bounds.min[axis] = rounded(min_[static_cast<std::size_t>(axis)]);
    bounds.max[axis] = rounded(end_[static_cast<std::size_t>(axis)]);
  }
  return bounds;
}

}  // namespace octurn
