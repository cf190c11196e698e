#include "depth/back_project.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "support/random.hpp"

namespace octurn {
namespace {

constexpr Intrinsics small_lens{
    .width = 4, .height = 3, .fx = 2.0, .fy = 4.0, .cx = 1.0, .cy = 2.0, .depth_unit = 0.001};

Snapshot snapshot_of(const Intrinsics& intrinsics, std::uint16_t depth) {
  const auto samples = static_cast<std::size_t>(intrinsics.width * intrinsics.height);
  return {.frame = {.width = intrinsics.width,
                    .height = intrinsics.height,
                    .depth = std::vector<std::uint16_t>(samples, depth)},
          .intrinsics = intrinsics,
          .object_from_sensor = Eigen::Isometry3d::Identity()};
}

/// The same point by the formula of `Intrinsics`, one sample at a time, in double precision.
Eigen::Vector3d point_by_hand(const Snapshot& snapshot, int u, int v) {
  const Intrinsics& intrinsics = snapshot.intrinsics;
  const auto index = static_cast<std::size_t>(v * intrinsics.width + u);
  const double z = snapshot.frame.depth[index] * intrinsics.depth_unit;
  return snapshot.object_from_sensor * Eigen::Vector3d((u - intrinsics.cx) * z / intrinsics.fx,
                                                       (v - intrinsics.cy) * z / intrinsics.fy, z);
}

TEST(WorldPoints, SpreadASampleByItsPlaceInTheImageAndItsDepth) {
  const PointGrid grid = world_points(snapshot_of(small_lens, 500));

  // At 0.5 m, column 3 is two columns right of the middle: 2 * 0.5 / 2 = 0.5 m to the right (+X).
  // Row 0 is two rows above the middle: 2 * 0.5 / 4 = 0.25 m up, which is -Y in the optical frame.
  EXPECT_EQ(grid.points[3], Eigen::Vector3f(0.5F, -0.25F, 0.5F));
  EXPECT_EQ(grid.points[2 * 4 + 1], Eigen::Vector3f(0.0F, 0.0F, 0.5F));
}

TEST(WorldPoints, AreInTheOrderOfTheImage) {
  Snapshot snapshot = snapshot_of(small_lens, 0);
  snapshot.frame.depth[2 * 4 + 3] = 500;

  const PointGrid grid = world_points(snapshot);

  ASSERT_EQ(grid.points.size(), 12U);
  EXPECT_EQ(grid.width, 4);
  EXPECT_EQ(grid.height, 3);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_FALSE(is_point(grid.points[i])) << i;
  }
  EXPECT_TRUE(is_point(grid.points[11]));
}

TEST(WorldPoints, AgreeWithTheFormulaAtEverySampleOfAKinect) {
  Snapshot snapshot = snapshot_of({}, 0);
  Random random(7);
  for (std::uint16_t& sample : snapshot.frame.depth) {
    sample = static_cast<std::uint16_t>(random.between(4000, 15000));  // 0.4 m to 1.5 m
  }
  snapshot.object_from_sensor =
      Eigen::Translation3d(0.02, -0.62, 0.31) *
      Eigen::AngleAxisd(-2.0, Eigen::Vector3d(0.96, 0.2, -0.1).normalized());

  const PointGrid grid = world_points(snapshot);

  double farthest = 0.0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const Eigen::Vector3f& point = grid.points[static_cast<std::size_t>(v * 640 + u)];
      farthest = std::max(farthest, (point.cast<double>() - point_by_hand(snapshot, u, v)).norm());
    }
  }
  // Some ten roundings of floats below 2 m, far below the sensor's unit of 0.1 mm.
  constexpr double rounding =
      2.0 * static_cast<double>(std::numeric_limits<float>::epsilon());  // metres
  EXPECT_LT(farthest, 10 * rounding);
}

TEST(WorldPoints, OfARectangleAreThoseOfTheWholeImage) {
  Snapshot snapshot = snapshot_of(small_lens, 500);
  for (std::size_t i = 0; i < 12; ++i) {
    snapshot.frame.depth[i] = static_cast<std::uint16_t>(500 + 10 * i);
  }
  const PointGrid whole = world_points(snapshot);

  const PointGrid part = world_points(snapshot, {.left = 1, .top = 1, .right = 3, .bottom = 3});

  EXPECT_EQ(part.width, 2);
  EXPECT_EQ(part.height, 2);
  ASSERT_EQ(part.points.size(), 4U);
  EXPECT_EQ(part.points[0], whole.points[1 * 4 + 1]);
  EXPECT_EQ(part.points[1], whole.points[1 * 4 + 2]);
  EXPECT_EQ(part.points[2], whole.points[2 * 4 + 1]);
  EXPECT_EQ(part.points[3], whole.points[2 * 4 + 2]);
}

TEST(WorldPoints, RefuseAFrameOfAnotherSizeThanTheIntrinsics) {
  Snapshot turned = snapshot_of(small_lens, 500);
  std::swap(turned.frame.width, turned.frame.height);
  Snapshot cut = snapshot_of(small_lens, 500);
  cut.frame.depth.pop_back();

  EXPECT_THROW(world_points(turned), std::invalid_argument);
  EXPECT_THROW(world_points(cut), std::invalid_argument);
}

TEST(Clip, KeepsPointsInsideTheBoxAndOnItsFaces) {
  const Box box{.min = {-0.5, -0.25, 0.125}, .max = {0.5, 0.25, 1.0}};
  PointGrid grid{.width = 3,
                 .height = 1,
                 .points = {{0.0F, 0.0F, 0.5F}, {-0.5F, -0.25F, 0.125F}, {0.5F, 0.25F, 1.0F}}};

  clip(grid, box);

  EXPECT_TRUE(is_point(grid.points[0]));
  EXPECT_TRUE(is_point(grid.points[1]));
  EXPECT_TRUE(is_point(grid.points[2]));
}

TEST(Clip, TakesAwayPointsBeyondEachFace) {
  const Box box{.min = {-0.5, -0.5, -0.5}, .max = {0.5, 0.5, 0.5}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      PointGrid grid{.width = 1, .height = 1, .points = {Eigen::Vector3f::Zero()}};
      grid.points[0][axis] = side * std::nextafter(0.5F, 1.0F);

      clip(grid, box);

      EXPECT_FALSE(is_point(grid.points[0])) << "axis " << axis << ", side " << side;
    }
  }
}

TEST(Clip, TakesAwayPointsThatAreNowhere) {
  const Box box{.min = {-0.5, -0.5, -0.5}, .max = {0.5, 0.5, 0.5}};
  const float nowhere = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  PointGrid grid{
      .width = 3,
      .height = 1,
      .points = {no_point, {0.0F, nowhere, 0.0F}, {0.0F, 0.0F, infinite}},
  };

  clip(grid, box);

  EXPECT_FALSE(is_point(grid.points[0]));
  EXPECT_FALSE(is_point(grid.points[1]));
  EXPECT_FALSE(is_point(grid.points[2]));
}

}  // namespace
}  // namespace octurn
