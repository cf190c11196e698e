#include "depth/seen_pixels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <random>

namespace octurn {
namespace {

/// The corners of a box of that size, turned about its centre, which is at `middle` (optical
/// frame).
std::array<Eigen::Vector3d, 8> corners_of(const Eigen::Vector3d& size,
                                          const Eigen::AngleAxisd& turn,
                                          const Eigen::Vector3d& middle) {
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d corner((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5,
                                 (i & 4U) != 0 ? 0.5 : -0.5);
    corners[i] = turn * corner.cwiseProduct(size) + middle;
  }
  return corners;
}

TEST(SeenPixels, HoldWhereEachPointOfABodyIsSeenAndFewOthers) {
  const Intrinsics lens;
  const Eigen::Vector3d size(0.1, 0.06, 0.2);
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  const Eigen::Vector3d middle(0.03, -0.02, 0.6);
  const PixelRectangle pixels = seen_pixels(lens, corners_of(size, turn, middle));

  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector3d inside(part(random), part(random), part(random));
    const Eigen::Vector2d seen = project(lens, turn * inside.cwiseProduct(size) + middle);
    EXPECT_TRUE(seen.x() > pixels.left && seen.y() > pixels.top && seen.x() < pixels.right - 1 &&
                seen.y() < pixels.bottom - 1)
        << seen.transpose();
  }
  // The body's diagonal is 0.23 m, and its nearest corner 0.12 m nearer than its middle.
  const double largest = 0.23 / 0.48 * lens.fx;
  EXPECT_LT(pixels.right - pixels.left, largest);
  EXPECT_LT(pixels.bottom - pixels.top, largest);
}

TEST(SeenPixels, AreAllWhereABodyReachesBehindTheSensor) {
  const Intrinsics lens;
  const PixelRectangle pixels =
      seen_pixels(lens, corners_of({0.1, 0.1, 1}, Eigen::AngleAxisd::Identity(), {0, 0, 0.4}));
  EXPECT_EQ(pixels.left, 0);
  EXPECT_EQ(pixels.top, 0);
  EXPECT_EQ(pixels.right, lens.width);
  EXPECT_EQ(pixels.bottom, lens.height);
}

TEST(SeenPixels, AreNoneBesideTheImage) {
  const PixelRectangle pixels =
      seen_pixels({}, corners_of({0.1, 0.1, 0.1}, Eigen::AngleAxisd::Identity(), {2, 0, 0.6}));
  EXPECT_EQ(pixels.left, pixels.right);
}

}  // namespace
}  // namespace octurn
