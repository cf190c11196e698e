#include "depth/condition_depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tsdf/rendered.hpp"

namespace octurn {
namespace {

const Box everywhere{.min = {-1, -1, -1}, .max = {1, 1, 1}};

Snapshot plane_snapshot(const Eigen::Vector3d& normal, double offset) {
  Snapshot snapshot{
      .frame = {.width = 64, .height = 48, .depth = {}},
      .intrinsics = {
          .width = 64, .height = 48, .fx = 60, .fy = 60, .cx = 32, .cy = 24, .depth_unit = 0.0001}};
  snapshot.object_from_sensor.translation().z() = 0.1;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const double z = -offset / normal.dot(Eigen::Vector3d((u - 32) / 60.0, (v - 24) / 60.0, 1));
      snapshot.frame.depth.push_back(static_cast<std::uint16_t>(std::lround(z / 0.0001)));
    }
  }
  return snapshot;
}

TEST(ConditionedDepth, FindsThePlaneThatItSees) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.1, -1).normalized();
  const ConditionedDepth conditioned(plane_snapshot(normal, 0.5), everywhere);
  for (int v = 4; v < 44; ++v) {
    for (int u = 4; u < 60; ++u) {
      const DepthObservation& observation = conditioned.at(u, v);
      ASSERT_GT(observation.weight, 0);
      // Depths are rounded to 0.05 mm; the window's samples are 9 mm apart.
      const Eigen::Vector3d found = Eigen::Vector3f(observation.normal.data()).cast<double>();
      EXPECT_LT((found - normal).norm(), 0.01);
      const double z = -0.5 / normal.dot(Eigen::Vector3d((u - 32) / 60.0, (v - 24) / 60.0, 1));
      const Eigen::Vector3d point(z * (u - 32) / 60.0, z * (v - 24) / 60.0, z);
      EXPECT_NEAR(found.dot(point) + static_cast<double>(observation.offset), 0, 0.0001);
    }
  }
}

TEST(ConditionedDepth, LeavesOutALoneReading) {
  Snapshot snapshot = plane_snapshot({0, 0, -1}, 0.5);
  for (const int column : {30, 31, 32}) {  // three readings that agree are too few to be kept
    snapshot.frame.depth[static_cast<std::size_t>(20 * 64 + column)] = 4500;
  }
  const ConditionedDepth conditioned(snapshot, everywhere);
  EXPECT_EQ(conditioned.at(31, 20).weight, 0);
  EXPECT_EQ(conditioned.at(31, 20).free_space_depth, 0);
  EXPECT_GT(conditioned.at(31, 24).weight, 0);
}

TEST(ConditionedDepth, HasNoSurfaceOutsideTheClipBoxButSeesAsFar) {
  const ConditionedDepth conditioned(plane_snapshot({0, 0, -1}, 0.5),
                                     {.min = {-0.1, -1, -1}, .max = {0.1, 1, 1}});
  EXPECT_GT(conditioned.at(32, 24).weight, 0);
  EXPECT_EQ(conditioned.at(60, 24).weight, 0);
  EXPECT_FLOAT_EQ(conditioned.at(60, 24).free_space_depth, 0.5F);
}

// A ray that ends on the platform, whose position is known, may free space nearly down to it. A ray
// that ends on anything else may not.
TEST(ConditionedDepth, SeesNearlyDownToThePlatformOfOneOfSeveralPoses) {
  const Snapshot snapshot = rendered(block({0.06, 0.06, 0.04}), 1).read(0);
  const Box clip{.min = {-0.1, -0.1, 0}, .max = {0.1, 0.1, 0.2}};
  const ConditionedDepth alone(snapshot, clip);
  const ConditionedDepth of_several(snapshot, clip, {.clip = clip});
  const ConditionedDepth of_a_lower_one(
      snapshot, clip,
      {.object_from_platform = Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.01)), .clip = clip});
  int on_platform = 0;
  int on_object = 0;
  int others = 0;  // pixels whose free space ends anywhere else
  for (int v = 2; v < 178; ++v) {
    for (int u = 2; u < 238; ++u) {
      const double z = snapshot.frame.depth[static_cast<std::size_t>(v * 240 + u)] * 0.0001;
      const Eigen::Vector3d seen(z * (u - 120) / 216.0, z * (v - 90) / 216.0, z);
      const double height = (snapshot.object_from_sensor * seen).z();
      const float free = alone.at(u, v).free_space_depth;
      const float further = of_several.at(u, v).free_space_depth - free;
      others += of_a_lower_one.at(u, v).free_space_depth == free ? 0 : 1;
      if (free > 0 && height < 0.002) {
        ++on_platform;
        others += std::abs(further - 0.0045F) < 1e-6F ? 0 : 1;
      } else if (height > 0.003) {
        ++on_object;
        others += further == 0 ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(others, 0);
  EXPECT_GT(on_platform, 5000);
  EXPECT_GT(on_object, 200);
}

TEST(ConditionedDepth, BoundsWhatEveryPixelOfARectangleSays) {
  const ConditionedDepth conditioned(rendered(hollowed_block({0.07, 0.05, 0.045}, 0.02), 1).read(0),
                                     {.min = {-0.1, -0.1, 0}, .max = {0.1, 0.1, 0.2}});
  int with_surface = 0;
  for (int i = 0; i < 2000; ++i) {
    const int u0 = i * 37 % 240;
    const int v0 = i * 101 % 180;
    const int u1 = std::min(u0 + i % 61, 239);
    const int v1 = std::min(v0 + i % 43, 179);
    const DepthPyramid::MinMax depth = conditioned.min_max(u0, v0, u1, v1);
    for (int v = v0; v <= v1; ++v) {
      for (int u = u0; u <= u1; ++u) {
        const DepthObservation& observation = conditioned.at(u, v);
        ASSERT_LE(depth.min_free, observation.free_space_depth);
        ASSERT_GE(depth.max_free, observation.free_space_depth);
        if (observation.weight > 0) {
          ASSERT_LE(depth.min_surface, observation.free_space_depth);
          ASSERT_GE(depth.max_surface, observation.free_space_depth);
          ++with_surface;
        }
      }
    }
  }
  EXPECT_GT(with_surface, 10000);
  EXPECT_EQ(conditioned.min_max(-1, 0, 5, 5).min_free, 0);
  EXPECT_EQ(conditioned.min_max(230, 170, 240, 175).min_free, 0);
}

}  // namespace
}  // namespace octurn
