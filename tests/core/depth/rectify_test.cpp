#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

const SensorOptics bent{.fx = 592, .fy = 591, .cx = 331.5, .cy = 245, .k1 = -0.12, .k2 = 0.03};

/// The undistorted coordinates of a pixel, found by bisection along its radius.
double undistorted(double radius, const SensorOptics& optics) {
  double low = 0;
  double high = 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    const double square = middle * middle;
    const double seen = middle * (1 + square * (optics.k1 + square * optics.k2));
    (seen < radius ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// The image of a plane, 1/z = 1.5 + slope x - 0.3 y, as a sensor of these optics reports it.
DepthFrame seen_plane(const SensorOptics& optics, double slope) {
  const Intrinsics sensor;
  DepthFrame frame{.width = sensor.width, .height = sensor.height, .depth = {}};
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double x = (u - optics.cx) / optics.fx;
      const double y = (v - optics.cy) / optics.fy;
      const double radius = std::hypot(x, y);
      const double factor = radius > 0 ? undistorted(radius, optics) / radius : 1;
      const double truth = 1.5 + slope * factor * x - 0.3 * factor * y;
      const double reported = truth * optics.depth_scale - optics.depth_offset_per_m;
      frame.depth.push_back(
          static_cast<std::uint16_t>(std::lround(1 / (reported * sensor.depth_unit))));
    }
  }
  return frame;
}

TEST(Rectified, MakesAPlaneThatAPinholeCameraSees) {
  SensorOptics optics = bent;
  optics.depth_scale = 1.02;
  optics.depth_offset_per_m = 0.006;
  const Intrinsics sensor;
  const Intrinsics pinhole = rectified(sensor, optics);
  const DepthFrame frame = rectified(seen_plane(optics, 0.4), sensor, optics);
  int compared = 0;
  for (int v = 20; v < 460; v += 7) {
    for (int u = 20; u < 620; u += 7) {
      const std::uint16_t depth = frame.depth[static_cast<std::size_t>(v * 640 + u)];
      const double x = (u - pinhole.cx) / pinhole.fx;
      const double y = (v - pinhole.cy) / pinhole.fy;
      if (depth > 0) {
        ++compared;
        // Both images are rounded to 0.1 mm.
        EXPECT_NEAR(depth * pinhole.depth_unit, 1 / (1.5 + 0.4 * x - 0.3 * y), 0.00015);
      }
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(Rectified, LeavesTheDepthsOfALensWithoutDistortion) {
  const SensorOptics straight{.fx = 590, .fy = 590, .cx = 330, .cy = 240, .depth_scale = 1.01};
  const DepthFrame frame = seen_plane(straight, 0.4);
  EXPECT_EQ(rectified(frame, {}, straight).depth, frame.depth);
  EXPECT_DOUBLE_EQ(rectified(Intrinsics{}, straight).depth_unit, 1.01 * Intrinsics().depth_unit);
}

TEST(Rectified, MixesNoDepthsAcrossAnEdge) {
  DepthFrame frame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const std::size_t u = i % 640;
    frame.depth[i] = u % 5 == 0 ? 0 : u % 2 == 0 ? 6000 : 9000;
  }
  for (const std::uint16_t depth : rectified(frame, {}, bent).depth) {
    ASSERT_TRUE(depth == 0 || depth == 6000 || depth == 9000) << depth;
  }
}

TEST(Rectified, RefusesAFrameOfAnotherSize) {
  EXPECT_THROW(rectified({.width = 1, .height = 1, .depth = {1}}, {}, bent), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
