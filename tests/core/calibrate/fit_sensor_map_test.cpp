#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "calibrate/wall_blocks.hpp"
#include "core/calibrate/rendered_wall.hpp"

namespace octurn {
namespace {

/// Deviation from a plane of a wall seen through the map: root mean square over the blocks of
/// 4 x 4 pixels, steps of disparity.
double unevenness(const InverseDepthAt& wall, const SensorMap* map = nullptr) {
  const Intrinsics lens;
  std::mt19937 random(77);
  WallView view(lens);
  for (int frame = 0; frame < 4; ++frame) {
    const DepthFrame seen = wall_frame(wall, random);
    view.add(map == nullptr ? seen : corrected(seen, *map, lens.depth_unit));
  }
  const WallBlocks blocks = make_wall_blocks(view);
  const WallPlane plane = fit_wall_plane(blocks);
  double squares = 0;
  for (const WallBlock& block : blocks.blocks) {
    const double off = block.inverse_depth - plane.inverse_depth(block.ray);
    squares += off * off / static_cast<double>(blocks.blocks.size());
  }
  return std::sqrt(squares) / disparity_unit;
}

SensorMapReport fit(const std::vector<WallView>& views) { return fit_sensor_map(views); }

std::string reason_of(const InverseDepthAt& wall) {
  const SensorMapReport report = fit({wall_view(wall)});
  EXPECT_FALSE(report.accepted);
  return report.reason;
}

TEST(FitSensorMap, FlattensAnotherWallAtTheSameDistance) {
  const SensorMapReport report = fit({wall_view(flat_wall(0.66, 4))});
  ASSERT_TRUE(report.accepted) << report.reason;
  EXPECT_TRUE(report.map.far.empty());
  EXPECT_NEAR(report.walls[0].distance, 0.66, 0.002);
  EXPECT_NEAR(report.walls[0].slant, radians_from_degrees(4), radians_from_degrees(0.3));
  EXPECT_EQ(report.walls[0].coverage, 1);
  const InverseDepthAt other = flat_wall(0.65, -6);
  EXPECT_GT(unevenness(other), 0.7);
  // Remaining error: rounding, half a step of noise over 64 readings, and the distance-dependent
  // share of the pattern, as the two walls' depths differ by up to 3 cm at the sides.
  EXPECT_LT(unevenness(other, &report.map), 0.2);
}

TEST(FitSensorMap, FollowsThePatternOverTheDistanceWithTwoWalls) {
  const SensorMapReport one = fit({wall_view(flat_wall(0.6, 4))});
  const SensorMapReport two =
      fit({wall_view(flat_wall(0.9, -3), 4, 2), wall_view(flat_wall(0.6, 4))});
  ASSERT_TRUE(two.accepted) << two.reason;
  EXPECT_NEAR(two.map.near_inverse_depth, 1 / 0.6, 0.01);
  EXPECT_NEAR(two.map.far_inverse_depth, 1 / 0.9, 0.01);
  for (const double distance : {0.6, 0.72, 0.9, 1.0}) {
    EXPECT_LT(unevenness(flat_wall(distance, 0), &two.map), 0.15) << distance;
  }
  EXPECT_GT(unevenness(flat_wall(0.9, 0), &one.map), 0.25);
}

TEST(FitSensorMap, MakesOneMapOfTwoWallsAtOneDistance) {
  const SensorMapReport report =
      fit({wall_view(flat_wall(0.66, 4)), wall_view(flat_wall(0.66, -4), 4, 2)});
  ASSERT_TRUE(report.accepted) << report.reason;
  EXPECT_TRUE(report.map.far.empty());
  EXPECT_LT(unevenness(flat_wall(0.66, 0), &report.map), 0.15);
}

TEST(FitSensorMap, TellsHowFlatTheWallIsBeforeAndAfter) {
  const InverseDepthAt wall = flat_wall(0.66, 0);
  const SensorMapReport report = fit({wall_view(wall)});
  EXPECT_NEAR(report.map.before / disparity_unit, unevenness(wall), 0.02);
  EXPECT_NEAR(report.map.after / disparity_unit, unevenness(wall, &report.map), 0.03);
}

TEST(FitSensorMap, FillsWhereTheSensorHasNoReadings) {
  const InverseDepthAt whole = flat_wall(0.66, 0);
  const SensorMapReport report = fit({wall_view([&](int u, int v) {
    const bool is_blind = u >= 632 || (u >= 200 && u < 300 && v >= 100 && v < 200);
    return is_blind ? 0 : whole(u, v);
  })});
  ASSERT_TRUE(report.accepted) << report.reason;
  EXPECT_NEAR(report.walls[0].coverage, 1 - (8 * 480 + 100 * 100) / (640.0 * 480), 1e-9);
  const SensorMap expected = fit({wall_view(whole)}).map;
  for (const auto& [u, v] : {std::array{639, 10}, std::array{250, 150}, std::array{210, 190}}) {
    const auto at = static_cast<std::size_t>(v * 640 + u);
    EXPECT_NEAR(report.map.near[at], expected.near[at], 1.2 * disparity_unit) << u << ", " << v;
  }
}

TEST(FitSensorMap, RefusesWhatIsNoWall) {
  const InverseDepthAt wall = flat_wall(0.66, 0);
  const auto behind = [](double distance, double shown) { return 1 / (1 / distance - shown); };
  EXPECT_NE(reason_of([&](int u, int v) {  // a corner of 90 degrees
              return u < 320 ? flat_wall(0.9, 45)(u, v) : flat_wall(0.9, -45)(u, v);
            })
                .find("no flat wall"),
            std::string::npos);
  EXPECT_NE(reason_of([&](int u, int v) {  // a person 30 cm in front of the wall
              return u > 250 && u < 350 && v > 100 ? 1 / 0.4 : flat_wall(0.7, 0)(u, v);
            })
                .find("no flat wall"),
            std::string::npos);
  EXPECT_NE(reason_of([&](int u, int v) {  // a picture frame of 8 x 10 cm, 1.5 cm thick
              const bool is_frame = u > 300 && u < 370 && v > 200 && v < 290;
              return is_frame ? behind(wall(u, v), 0.015) : wall(u, v);
            })
                .find("hangs on the wall"),
            std::string::npos);
  EXPECT_NE(reason_of(flat_wall(0.66, 25)).find("slanted by 25"), std::string::npos);
  EXPECT_NE(reason_of(flat_wall(2.5, 0)).find("2.5 m away"), std::string::npos);
  EXPECT_NE(reason_of([&](int u, int v) { return v < 60 ? 0 : wall(u, v); }).find("only 88 %"),
            std::string::npos);
  EXPECT_NE(reason_of([](int, int) { return 0.0; }).find("only 0 %"), std::string::npos);
  EXPECT_NE(reason_of([&](int u, int v) {  // plaster with grooves 14 mm apart
              return wall(u, v) + 2.2 * disparity_unit * std::sin(u * 0.5);
            })
                .find("rough"),
            std::string::npos);
}

TEST(FitSensorMap, RefusesWallsOfWhichOneIsBent) {
  const InverseDepthAt bent = [](int u, int v) {
    return flat_wall(0.8, 0)(u, v) + 2.5 * disparity_unit * std::cos(u * 0.02);
  };
  const SensorMapReport report = fit({wall_view(flat_wall(0.66, 0)), wall_view(bent)});
  EXPECT_FALSE(report.accepted);
  EXPECT_NE(report.reason.find("disagree"), std::string::npos) << report.reason;
}

TEST(FitSensorMap, NamesTheWallThatIsNone) {
  const SensorMapReport report =
      fit({wall_view(flat_wall(0.66, 0)), wall_view(flat_wall(0.66, 30))});
  EXPECT_EQ(report.reason.find("wall 2: "), 0U) << report.reason;
  EXPECT_EQ(report.walls.size(), 2U);
}

/// Root mean square of the difference of two maps' errors, steps of disparity.
double difference(const SensorMap& one, const SensorMap& other) {
  double squares = 0;
  for (std::size_t i = 0; i < one.near.size(); ++i) {
    const double off = static_cast<double>(one.near[i] - other.near[i]);
    squares += off * off / static_cast<double>(one.near.size());
  }
  return std::sqrt(squares) / disparity_unit;
}

// A lens's distortion bends a slanted wall. Where optics take it out, a map must not do so again.
TEST(FitSensorMap, LeavesDistortionToKnownOptics) {
  const SensorOptics optics{.fx = 590, .fy = 590, .cx = 331, .cy = 246, .k1 = -0.12, .k2 = 0.02};
  const double tangent = std::tan(radians_from_degrees(14));
  const auto seen = [&](int u, int v) {
    const Eigen::Vector2d shown((u - optics.cx) / optics.fx, (v - optics.cy) / optics.fy);
    Eigen::Vector2d ray = shown;  // the fixed point of r = shown / (1 + k1 r^2 + k2 r^4)
    for (int i = 0; i < 60; ++i) {
      const double square = ray.squaredNorm();
      ray = shown / (1 + square * (optics.k1 + square * optics.k2));
    }
    return (1 - tangent * ray.x()) / 0.66;
  };
  const std::vector<WallView> views{wall_view(seen)};
  const SensorMapReport known = fit_sensor_map(views, optics);
  const SensorMapReport unknown = fit_sensor_map(views);
  ASSERT_TRUE(known.accepted) << known.reason;
  EXPECT_EQ(known.map.optics, optics);
  EXPECT_FALSE(unknown.map.optics);
  const SensorMap pattern = fit({wall_view(flat_wall(0.66, 0))}).map;
  // The pattern changes with distance, which is up to 10 cm different at the sides.
  EXPECT_LT(difference(known.map, pattern), 0.15);
  EXPECT_GT(difference(unknown.map, pattern), 0.4);
}

TEST(FitSensorMap, TakesViewsOfOneSensor) {
  EXPECT_THROW(fit({}), std::invalid_argument);
  EXPECT_THROW(fit({wall_view(flat_wall(0.66, 0)), WallView({.width = 4, .height = 3})}),
               std::invalid_argument);
  EXPECT_THROW(WallView(Intrinsics{}).add({.width = 1, .height = 1, .depth = {1}}),
               std::invalid_argument);
}

TEST(WallView, HasAReadingWhereHalfOfItsFramesHaveOne) {
  WallView view({.width = 2, .height = 2});
  view.add({.width = 2, .height = 2, .depth = {5000, 5000, 5000, 0}});
  view.add({.width = 2, .height = 2, .depth = {5000, 0, 10000, 0}});
  view.add({.width = 2, .height = 2, .depth = {5000, 0, 0, 0}});
  EXPECT_EQ(view.frames(), 3);
  EXPECT_NEAR(view.inverse_depth(0, 0), 2, 1e-6);
  EXPECT_EQ(view.inverse_depth(1, 0), 0);
  EXPECT_NEAR(view.inverse_depth(0, 1), 1.5, 1e-6);
  EXPECT_EQ(view.inverse_depth(1, 1), 0);
}

}  // namespace
}  // namespace octurn
