#include "simulator/sensor_unit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "simulator/camera.hpp"

namespace octurn {
namespace {

constexpr double foot = 1.2;      // 1/m, of a plane's inverse depth at the first pixel
constexpr double slope = 0.0004;  // 1/m for each pixel

/// A plane whose inverse depth tells the column, or the row, of the pinhole camera's picture.
InverseDepth slanted(const Intrinsics& picture, bool along_rows) {
  InverseDepth plane;
  for (int v = 0; v < picture.height; ++v) {
    for (int u = 0; u < picture.width; ++u) {
      plane.push_back(static_cast<float>(foot + slope * (along_rows ? u : v)));
    }
  }
  return plane;
}

/// Where in the pinhole camera's picture a sensor without error of depth sees a pixel.
double seen_at(const InverseDepth& seen, int u, int v) {
  return (static_cast<double>(seen[static_cast<std::size_t>(v * camera.width + u)]) - foot) / slope;
}

TEST(SensorUnit, SeesWhatAPinholeCameraSeesWithTheDataSheetsOptics) {
  const InverseDepth plane = slanted(camera, true);
  EXPECT_EQ(SensorView(optics_of_unit(0)).of(plane), plane);
}

TEST(SensorUnit, ShowsEachPixelWhereItsDistortionPutsIt) {
  // Of the units that are drawn, none sees further out of the pinhole camera's picture.
  const SensorOptics optics{.fx = 573, .fy = 573, .cx = 336, .cy = 250, .k1 = -0.18};
  const Intrinsics picture = pinhole_of(optics);
  const SensorView view(optics);
  const InverseDepth columns = view.of(slanted(picture, true));
  const InverseDepth rows = view.of(slanted(picture, false));

  for (const int v : {0, 100, 250, 479}) {
    for (const int u : {0, 200, 336, 639}) {
      const double x = (seen_at(columns, u, v) - picture.cx) / picture.fx;
      const double y = (seen_at(rows, u, v) - picture.cy) / picture.fy;
      const double stretch = 1 + optics.k1 * (x * x + y * y);
      EXPECT_NEAR(x * stretch * optics.fx + optics.cx, u, 0.02) << u << ", " << v;
      EXPECT_NEAR(y * stretch * optics.fy + optics.cy, v, 0.02) << u << ", " << v;
    }
  }
}

TEST(SensorUnit, ReportsDepthsByItsOwnScaleAndOffset) {
  const SensorOptics optics{.depth_scale = 1.012, .depth_offset_per_m = 0.003};
  const InverseDepth seen = SensorView(optics).of(InverseDepth(pixels(camera), 1 / 0.7F));
  const double reported = static_cast<double>(seen[1000]);
  EXPECT_NEAR((reported + optics.depth_offset_per_m) / optics.depth_scale, 1 / 0.7, 1e-6);
}

TEST(SensorUnit, DrawsOpticsWithinThoseOfPublishedUnits) {
  for (std::uint32_t unit = 1; unit < 50; ++unit) {
    const SensorOptics optics = optics_of_unit(unit);
    EXPECT_GT(optics.fx, 570) << unit;
    EXPECT_LT(optics.fx, 600) << unit;
    EXPECT_LT(std::hypot(optics.cx - camera.cx, optics.cy - camera.cy), 20) << unit;
    EXPECT_GT(optics.k1, -0.26) << unit;
    EXPECT_LT(optics.k1, 0) << unit;
    EXPECT_NEAR(optics.depth_scale, 1, 0.025) << unit;
    EXPECT_TRUE(optics == optics_of_unit(unit)) << unit;
  }
  EXPECT_FALSE(optics_of_unit(2) == optics_of_unit(3));
}

}  // namespace
}  // namespace octurn
