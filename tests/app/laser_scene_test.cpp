#include "simulator/laser_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "rig/nominal_laser_rig.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// An ASCII STL of a box on the platform, 30 mm to each side of the axis. @param height  metres
std::string box_stl(double height) {
  const std::array<Vector3d, 8> corners{Vector3d(-30, -30, 0),      Vector3d(30, -30, 0),
                                        Vector3d(30, 30, 0),        Vector3d(-30, 30, 0),
                                        Vector3d(-30, -30, height), Vector3d(30, -30, height),
                                        Vector3d(30, 30, height),   Vector3d(-30, 30, height)};
  constexpr std::array<std::array<std::size_t, 3>, 12> triangles{{{0, 2, 1},
                                                                  {0, 3, 2},
                                                                  {4, 5, 6},
                                                                  {4, 6, 7},
                                                                  {0, 1, 5},
                                                                  {0, 5, 4},
                                                                  {1, 2, 6},
                                                                  {1, 6, 5},
                                                                  {2, 3, 7},
                                                                  {2, 7, 6},
                                                                  {3, 0, 4},
                                                                  {3, 4, 7}}};
  std::ostringstream text;
  text << "solid box\n";
  for (const auto& triangle : triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const std::size_t corner : triangle) {
      text << "vertex " << corners[corner].transpose() << "\n";
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid box\n";
  return text.str();
}

class LaserSceneTest : public ::testing::Test {
 protected:
  LaserSceneTest() { std::ofstream(file_) << box_stl(40); }

  LaserSimulation simulation() const {
    return {
        .mesh_file = file_,
        .lens = {.width = 410, .height = 308, .fx = 341.2, .fy = 341.2, .cx = 204.5, .cy = 153.5},
        .platform_from_sensor = nominal_platform_from_camera(),
        .lasers = {nominal_laser("left", -0.5), nominal_laser("right", 0.5)}};
  }

  /// The column where `lit` exceeds `dark` most in a row; nothing if nowhere by more than the
  /// noise.
  static std::optional<int> brightest(const Picture& dark, const Picture& lit, int row) {
    int best = 8;  // grey levels, three times the noise
    std::optional<int> found;
    for (int u = 0; u < lit.width; ++u) {
      const auto pixel = static_cast<std::size_t>(row * lit.width + u);
      const int more = lit.samples[pixel] - dark.samples[pixel];
      if (more > best) {
        best = more;
        found = u;
      }
    }
    return found;
  }

  /// The intersection of a pixel's ray with a laser's plane, platform's frame, metres.
  static Vector3d meet(const LaserSimulation& of, std::size_t laser, int u, int v) {
    const Vector3d ray((u - of.lens.cx) / of.lens.fx, (v - of.lens.cy) / of.lens.fy, 1);
    const Laser& plane = of.lasers[laser];
    return of.platform_from_sensor * (ray * (plane.distance / plane.normal.dot(ray)));
  }

  TemporaryFolder folder_ = {};
  std::string file_ = folder_.path() / "box.stl";
};

/// Error bound, metres: on the object a pixel is 0.9 mm wide, and the brightest pixel lies within
/// one pixel of the line.
constexpr double pixel_on_box = 0.0012;

TEST_F(LaserSceneTest, HasTheLineWhereItsPlaneMeetsTheBoxOrThePlatform) {
  const LaserSimulation told = simulation();
  LaserScene scene(told);
  const Picture dark = scene.expose(0, {});
  for (std::size_t laser = 0; laser < 2; ++laser) {
    const Picture lit = scene.expose(0, laser);
    int on_box = 0;
    int on_platform = 0;
    for (int v = 0; v < told.lens.height; ++v) {
      const auto u = brightest(dark, lit, v);
      if (!u) {
        continue;
      }
      const Vector3d point = meet(told, laser, *u, v);
      const double side = std::max(std::abs(point.x()), std::abs(point.y())) - 0.03;  // box: 0
      const bool is_top = side < pixel_on_box && std::abs(point.z() - 0.04) < 2 * pixel_on_box;
      const bool is_side =
          std::abs(side) < 2 * pixel_on_box && point.z() > -pixel_on_box && point.z() < 0.042;
      const bool is_platform = std::abs(point.z()) < 2 * pixel_on_box && side > -pixel_on_box;
      const bool is_below = point.z() < -0.01;  // edge, table, wall
      on_box += is_top || is_side ? 1 : 0;
      on_platform += is_platform ? 1 : 0;
      EXPECT_TRUE(is_top || is_side || is_platform || is_below)
          << "row " << v << ": " << point.transpose();
    }
    EXPECT_GT(on_box, 40);
    EXPECT_GT(on_platform, 10);
  }
}

TEST_F(LaserSceneTest, ThrowsTheLasersShadow) {
  LaserSimulation told = simulation();
  told.lasers = {nominal_laser("aside", 1.2)};  // so that the camera sees the shadow
  // The camera sees that place at a grazing angle; large pixels would blur the line away.
  told.lens = {.width = 1640, .height = 1232, .fx = 1364.8, .fy = 1364.8, .cx = 819.5, .cy = 615.5};
  const Vector3d source = told.platform_from_sensor * *told.lasers[0].source;
  // Length of the shadow behind the box's edge at x = -0.03, by similar triangles: the edge's
  // distance from the laser, times the box's height of 4 cm over the laser's height above it.
  const double shadow = (source.x() + 0.03) * 0.04 / (source.z() - 0.04);
  const auto lit_points = [&](double from_x, double to_x) {
    LaserScene scene(told);
    const Picture dark = scene.expose(0, {});
    const Picture lit = scene.expose(0, 0);
    int points = 0;
    for (int v = 0; v < told.lens.height; ++v) {
      for (int u = 0; u < told.lens.width; ++u) {
        const auto sample = static_cast<std::size_t>(v * told.lens.width + u);
        const Vector3d point = meet(told, 0, u, v);
        const bool is_there =
            std::abs(point.z()) < 2 * pixel_on_box && point.x() > from_x && point.x() < to_x;
        points += is_there && lit.samples[sample] > dark.samples[sample] + 8 ? 1 : 0;
      }
    }
    return points;
  };
  const double begin = -0.03 - 2 * pixel_on_box;
  const double end = -0.03 - shadow;
  EXPECT_EQ(lit_points(end + 3 * pixel_on_box, begin), 0);
  EXPECT_GT(lit_points(-0.14, end - 3 * pixel_on_box), 2);
  std::ofstream(file_) << box_stl(0.5);  // 0.5 mm high: hardly any shadow
  EXPECT_GT(lit_points(end + 3 * pixel_on_box, begin), 4);
}

TEST_F(LaserSceneTest, TakesTheSamePicturesForTheSameSeed) {
  LaserScene first(simulation());
  LaserScene second(simulation());
  for (const std::optional<std::size_t> lit : {std::optional<std::size_t>{}, {1}}) {
    EXPECT_TRUE(first.expose(0.3, lit).samples == second.expose(0.3, lit).samples);
  }
  EXPECT_FALSE(first.expose(0.3, {}).samples == first.expose(0.3, {}).samples);  // noise
}

// The dark picture can be subtracted whether it is stored in colour or in grey.
TEST_F(LaserSceneTest, HasColoursOfThePicturesLuminance) {
  LaserScene scene(simulation());
  LaserScene same(simulation());
  const ColourExposure seen = scene.expose_in_colour(0.3, {});
  EXPECT_TRUE(seen.picture.samples == same.expose(0.3, {}).samples);
  ASSERT_EQ(seen.colours.size(), seen.picture.samples.size());
  for (std::size_t i = 0; i < seen.colours.size(); ++i) {
    const auto& [r, g, b] = seen.colours[i];
    ASSERT_NEAR(0.299 * r + 0.587 * g + 0.114 * b, seen.picture.samples[i], 1.01) << i;
  }
}

// Red is strongest in the direction of the object's Y axis, and blue in that of its X axis.
TEST_F(LaserSceneTest, PaintsTheObjectOnceRoundItsAxis) {
  const LaserSimulation told = simulation();
  LaserScene scene(told);
  constexpr double quarter = std::numbers::pi / 2;
  for (int side = 0; side < 4; ++side) {
    // This side faces the camera, which looks along Y.
    const ColourExposure seen = scene.expose_in_colour(side * quarter, {});
    const Vector3d at = told.platform_from_sensor.inverse() * Vector3d(0, -0.03, 0.02);
    const int u = static_cast<int>(std::lround(told.lens.fx * at.x() / at.z() + told.lens.cx));
    const int v = static_cast<int>(std::lround(told.lens.fy * at.y() / at.z() + told.lens.cy));
    Vector3d sum = Vector3d::Zero();
    for (int y = v - 10; y <= v + 10; ++y) {
      for (int x = u - 3; x <= u + 3; ++x) {
        const auto& [r, g, b] = seen.colours[static_cast<std::size_t>(y * told.lens.width + x)];
        sum += Vector3d(r, g, b);
      }
    }
    const double light = sum.dot(Vector3d(0.299, 0.587, 0.114));
    const double azimuth = -quarter - side * quarter;  // of that side, in the object's frame
    EXPECT_NEAR((sum.z() / light - 1) / 1.772, 0.4 * std::cos(azimuth), 0.06) << side;
    EXPECT_NEAR((sum.x() / light - 1) / 1.402, 0.4 * std::sin(azimuth), 0.06) << side;
  }
}

TEST_F(LaserSceneTest, TurnsWithThePlatform) {
  const LaserSimulation told = simulation();
  LaserScene scene(told);
  constexpr double quarter = std::numbers::pi / 2;
  for (const double angle : {0.0, quarter / 2, quarter}) {
    const Picture dark = scene.expose(angle, {});
    const Picture lit = scene.expose(angle, 0);
    double sum = 0;
    int points = 0;
    for (int v = 0; v < lit.height; ++v) {
      if (const auto u = brightest(dark, lit, v)) {
        const Vector3d point = meet(told, 0, *u, v);
        const bool is_side = point.z() > 0.005 && point.z() < 0.035;
        sum += is_side ? std::hypot(point.x(), point.y()) : 0;
        points += is_side ? 1 : 0;
      }
    }
    ASSERT_GT(points, 20);
    // The laser's plane makes an angle of 0.5 radians with the normal of the lit face.
    const double off = angle == quarter / 2 ? quarter / 2 - 0.5 : 0.5;
    EXPECT_NEAR(sum / points, 0.03 / std::cos(off), 0.0005) << angle;
  }
}

}  // namespace
}  // namespace octurn
