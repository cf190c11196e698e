#include "tsdf/known_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

constexpr int side = 60;            // of the block_grid, blocks
constexpr double ball_radius = 16;  // of the observed half of a sphere, blocks
constexpr int middle = side / 2;

const VoxelGrid block_grid(0.256, 8, {.min = {-0.1, -0.1, 0}, .max = {0.1, 0.1, 0.2}}, 0.003);

double block_side() { return block_grid.voxel_side() * block_grid.block_voxels(); }

/// Distance of a block from the sphere's middle, blocks.
double distance(int x, int y, int z) { return std::hypot(x - middle, y - middle, z - middle); }

/// Calls `visit(x, y, z, index)` for each block.
template <typename Visit>
void for_each(const KnownBlocks& blocks, Visit visit) {
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        visit(x, y, z, blocks.distances.index(x, y, z));
      }
    }
  }
}

/// The half of a sphere towards -X was observed, and nothing else is known.
KnownBlocks half_a_sphere() {
  KnownBlocks blocks;
  blocks.distances.size = {side, side, side};
  blocks.distances.values.resize(blocks.distances.index(0, 0, side));
  blocks.distances.known.resize(blocks.distances.values.size());
  for_each(blocks, [&](int x, int y, int z, std::size_t index) {
    if (x <= middle && std::abs(distance(x, y, z) - ball_radius) < 0.8) {
      blocks.distances.known[index] = 1;
    }
  });
  return blocks;
}

TEST(LimitBulges, MakesFreeWhatLiesOutsideTheHullOfWhatWasObserved) {
  const KnownBlocks before = half_a_sphere();
  KnownBlocks after = before;
  const double reach = 3;  // blocks
  limit_bulges(after, block_grid, reach * block_side());

  int freed = 0;
  for_each(before, [&](int x, int y, int z, std::size_t index) {
    const bool is_freed = before.distances.known[index] == 0 && after.distances.known[index] != 0;
    freed += is_freed ? 1 : 0;
    if (before.distances.known[index] != 0) {
      EXPECT_EQ(after.distances.values[index], 0) << "observed, and changed";
    } else if (x <= middle && distance(x, y, z) < ball_radius) {
      EXPECT_FALSE(is_freed) << "inside: " << x << " " << y << " " << z;
    } else if (x > middle + reach + 1 || distance(x, y, z) > 1.2 * ball_radius + reach + 1) {
      // The hull of 26 planes is up to 12 % wider than a sphere.
      EXPECT_TRUE(is_freed) << "outside: " << x << " " << y << " " << z;
      EXPECT_GT(after.distances.values[index], 0);
    }
  });
  EXPECT_GT(freed, side * side * side / 2);
}

TEST(LimitBulges, IsNotMisledByAStrayReading) {
  KnownBlocks blocks = half_a_sphere();
  blocks.distances.known[blocks.distances.index(side - 2, middle, middle)] = 1;
  limit_bulges(blocks, block_grid, block_side());
  EXPECT_NE(blocks.distances.known[blocks.distances.index(side - 4, middle, middle)], 0);
}

TEST(LimitBulges, LeavesWhatIsUnknownWhereNothingWasObserved) {
  KnownBlocks blocks = half_a_sphere();
  std::ranges::fill(blocks.distances.known, 0);
  limit_bulges(blocks, block_grid, block_side());
  EXPECT_TRUE(std::ranges::all_of(blocks.distances.known, [](char known) { return known == 0; }));
}

}  // namespace
}  // namespace octurn
