#include "bennett/voxelize_triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/bennett/comparison.hpp"
#include "core/bennett/plain_octree.hpp"
#include "core/bennett/soup.hpp"

namespace octurn {
namespace {

class VoxelizeTriangleAtLevel : public testing::TestWithParam<int> {};

TEST_P(VoxelizeTriangleAtLevel, FindsTheLeavesThatSeparatingAxesFind) {
  const int levels = GetParam();
  Soup soup(static_cast<std::uint32_t>(levels), levels);
  std::size_t met = 0;
  for (int i = 0; i < 400; ++i) {
    const std::array<SnapPoint, 3> corners = soup.triangle();
    if (leaves_across(corners, levels) > 64) {
      continue;  // too many leaves for the plain octree
    }
    Octree octree(1.0, levels);
    plain::Octree plain(levels);
    voxelize_triangle(octree, corners[0], corners[1], corners[2]);
    plain.voxelize(corners);
    ASSERT_EQ(leaves_of(octree), plain.leaves()) << "triangle " << i;
    met += plain.leaves().size();
  }
  EXPECT_GT(met, 100U);
}

INSTANTIATE_TEST_SUITE_P(Levels, VoxelizeTriangleAtLevel,
                         testing::Values(0, 1, 2, 3, 4, 5, 6, 8, 10, 13, 16));

TEST(VoxelizeTriangle, DoesNotDependOnTheOrderOfCorners) {
  constexpr int levels = 6;
  Soup soup(7, levels);
  for (int i = 0; i < 300; ++i) {
    const auto [a, b, c] = soup.triangle();
    Octree one(1.0, levels);
    Octree other(1.0, levels);
    voxelize_triangle(one, a, b, c);
    voxelize_triangle(other, c, b, a);
    ASSERT_EQ(leaves_of(one), leaves_of(other));
  }
}

TEST(VoxelizeTriangle, MeetsTheSameNodesAtACoarseLevelAsDirectly) {
  Soup soup(11, 8);
  Octree fine(1.0, 8);
  Octree coarse(1.0, 5);
  for (int i = 0; i < 60; ++i) {
    const auto [a, b, c] = soup.triangle();
    voxelize_triangle(fine, a, b, c);
    voxelize_triangle(coarse, a, b, c);
  }
  EXPECT_EQ(leaves_of(fine.at_level(5)), leaves_of(coarse));
  EXPECT_GT(coarse.leaf_count(), 100U);
}

TEST(SnapGrid, HasAPointWithinHalfAUnit) {
  const SnapGrid snap_grid(1.0);
  const Eigen::Vector3f point(0.12345F, -0.4321F, 0.98765F);
  const auto nearest = snap_grid.snap(point);
  ASSERT_TRUE(nearest);
  const double half_unit = 1.0 / (1 << SnapGrid::bits);
  EXPECT_NEAR((*nearest)[0] * half_unit, 0.5 + 0.12345, half_unit);
  EXPECT_NEAR((*nearest)[1] * half_unit, 0.5 - 0.4321, half_unit);
  EXPECT_NEAR((*nearest)[2] * half_unit, 0.98765, half_unit);
}

TEST(SnapGrid, HasNoneForNoPointAndForOneFarOutside) {
  const SnapGrid snap_grid(1.0);
  EXPECT_FALSE(snap_grid.snap(Eigen::Vector3f::Constant(std::nanf(""))));
  EXPECT_FALSE(snap_grid.snap({0.0F, 0.0F, 2.0F}));
  EXPECT_FALSE(snap_grid.snap({0.0F, -1.6F, 0.0F}));
  EXPECT_TRUE(snap_grid.snap({0.0F, -1.4F, 1.9F}));
}

}  // namespace
}  // namespace octurn
