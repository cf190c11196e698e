#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "register/seen_turn.hpp"

namespace octurn {
namespace {

constexpr double wall = 0.7;  // metres in front of each sensor

/// Poses (sensor from turn) of sensors around the turn's origin, all of which look at it.
std::vector<Eigen::Isometry3d> sensors_around(std::size_t count) {
  std::vector<Eigen::Isometry3d> sensors;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Isometry3d sensor_from_turn = Eigen::Isometry3d::Identity();
    sensor_from_turn.linear() =
        Eigen::AngleAxisd(0.4 * static_cast<double>(i), Eigen::Vector3d::UnitY())
            .toRotationMatrix();
    sensor_from_turn.translation() = Eigen::Vector3d(0, 0, 0.6);
    sensors.push_back(sensor_from_turn);
  }
  return sensors;
}

DepthFrame wall_frame(const Intrinsics& lens) {
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  return {.width = lens.width,
          .height = lens.height,
          .depth = std::vector<std::uint16_t>(
              pixels, static_cast<std::uint16_t>(std::lround(wall / lens.depth_unit)))};
}

TEST(FreeRays, PassPointsThatLieWellBeforeWhatEnoughStopsSaw) {
  const Intrinsics lens;
  for (const std::size_t count : {1U, 7U, 8U, 9U, 24U}) {
    const std::vector<Eigen::Isometry3d> sensors = sensors_around(count);
    const FreeRays rays(lens, sensors, {count, find_free_depths(wall_frame(lens))});
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-0.4, 0.4);
    int passed = 0;
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d point(place(random), place(random) / 4, place(random));
      int expected = 0;
      for (const Eigen::Isometry3d& sensor_from_turn : sensors) {
        const Eigen::Vector3d seen = sensor_from_turn * point;
        const double u = seen.x() / seen.z() * lens.fx + lens.cx;
        const double v = seen.y() / seen.z() * lens.fy + lens.cy;
        const bool is_seen = u > -0.5 && v > -0.5 && u < lens.width - 0.5 && v < lens.height - 0.5;
        expected += is_seen && seen.z() > 0.05 && seen.z() < wall - 0.006 ? 1 : 0;
      }
      for (const int min_stops : {1, 2, 5}) {
        EXPECT_EQ(rays.pass(point, min_stops), expected >= min_stops) << point.transpose();
      }
      passed += expected >= 2 ? 1 : 0;
    }
    EXPECT_TRUE(count < 2 || (passed > 20 && passed < 280));  // some points pass, some do not
  }
}

TEST(FreeRays, ReachTheNearestReadingOfABlockThatMostlyHasReadings) {
  DepthFrame frame{.width = 10, .height = 5, .depth = std::vector<std::uint16_t>(50, 7000)};
  frame.depth[3 * 10 + 2] = 6500;  // in the first block
  for (const std::size_t i : {4U, 5U, 6U, 7U, 14U, 15U, 16U, 17U, 24U}) {
    frame.depth[i] = 0;  // nine of the second block's sixteen pixels
  }
  // Blocks at the right and bottom edges are partial: the last of the first row has 8 pixels, all
  // of them read.
  EXPECT_EQ(find_free_depths(frame), (FreeDepths{6500, 0, 7000, 0, 0, 0}));
}

}  // namespace
}  // namespace octurn
