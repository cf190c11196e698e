#include <gtest/gtest.h>

#include "depth/condition_depth.hpp"

namespace octurn {
namespace {

/// A plane in space is linear in inverse depth: 1/z = 2 + 0.001 du - 0.002 dv.
DepthImage plane_image() {
  DepthImage image{.width = 9, .height = 9, .z = {}};
  for (int v = 0; v < 9; ++v) {
    for (int u = 0; u < 9; ++u) {
      image.z.push_back(
          1 / (2 + 0.001F * static_cast<float>(u - 4) - 0.002F * static_cast<float>(v - 4)));
    }
  }
  return image;
}

void set(DepthImage& image, int u, int v, float z) { image.row(v)[u] = z; }

TEST(FitPlane, RecoversAPlaneFromItsReadings) {
  const DepthImage image = plane_image();
  const auto fit = fit_plane(image, to_inverse_depth(image), 4, 4);
  ASSERT_TRUE(fit);
  // Readings of floats near 0.5 m are rounded by 3e-8 m, inverse depths of 2/m by 2e-7/m.
  EXPECT_NEAR(fit->inverse_depth, 2, 1e-6);
  EXPECT_NEAR(fit->slope_u, 0.001, 1e-6);
  EXPECT_NEAR(fit->slope_v, -0.002, 1e-6);
  EXPECT_EQ(fit->samples, 25);
}

TEST(FitPlane, LeavesOutReadingsOfAnotherSurface) {
  DepthImage image = plane_image();
  set(image, 5, 4, 0.6F);
  set(image, 3, 3, 0);
  const auto fit = fit_plane(image, to_inverse_depth(image), 4, 4);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->inverse_depth, 2, 1e-6);
  EXPECT_EQ(fit->samples, 23);
}

TEST(FitPlane, HasNoPlaneForTooFewReadingsOrALine) {
  DepthImage line = plane_image();
  DepthImage few = plane_image();
  for (int v = 0; v < 9; ++v) {
    for (int u = 0; u < 9; ++u) {
      if (u != 4) {
        set(line, u, v, 0);
      }
      if (u < 3 || u > 5 || v < 4 || v > 6 || (u == 5 && v == 6)) {  // keeps eight samples
        set(few, u, v, 0);
      }
    }
  }
  EXPECT_FALSE(fit_plane(line, to_inverse_depth(line), 4, 4));
  EXPECT_FALSE(fit_plane(few, to_inverse_depth(few), 4, 4));
}

TEST(RemoveSpeckle, KeepsAReadingThatFourNeighboursSupport) {
  DepthImage image{.width = 5, .height = 5, .z = std::vector<float>(25, 0)};
  for (const auto& [u, v] : {std::pair{2, 2}, {1, 2}, {3, 2}, {2, 1}}) {
    set(image, u, v, 0.5F);
  }
  EXPECT_EQ(remove_speckle(image).at(2, 2), 0);  // three neighbours are too few
  set(image, 2, 3, 0.5F + 0.009F);               // beyond the step limit
  EXPECT_EQ(remove_speckle(image).at(2, 2), 0);
  set(image, 2, 3, 0.5F + 0.007F);
  EXPECT_EQ(remove_speckle(image).at(2, 2), 0.5F);
}

}  // namespace
}  // namespace octurn
