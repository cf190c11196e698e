#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "calibrate/surface_findings.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::size_t stops = 12;

/// Evenly spaced stop angles of one turn, radians.
std::vector<double> angles() {
  std::vector<double> angles;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    angles.push_back(2 * std::numbers::pi * static_cast<double>(stop) / stops);
  }
  return angles;
}

/// The planes of a platform that tilts by 0.4 degrees as it turns, with noise of 0.02 degrees and
/// 0.02 mm.
/// @param moved  added to each stop's plane
std::vector<StopPlane> planes(const std::function<StopPlane(std::size_t stop)>& moved) {
  std::mt19937 random(3);
  const auto noise = [&] { return 2 * static_cast<double>(random()) / 4294967295.0 - 1; };
  std::vector<StopPlane> planes;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    StopPlane plane = moved(stop);
    plane.tilt +=
        Eigen::Rotation2Dd(angles()[stop]) * Eigen::Vector2d(radians_from_degrees(0.4), 0);
    plane.tilt += radians_from_degrees(0.02) * Eigen::Vector2d(noise(), noise());
    plane.height += 2e-5 * noise();
    planes.push_back(plane);
  }
  return planes;
}

TEST(SensorStep, IsFoundBesideAWobble) {
  const auto step = solve_sensor_step(
      planes([](std::size_t stop) {
        return stop < 7 ? StopPlane{} : StopPlane{.tilt = {0.003, -0.004}, .height = -0.0008};
      }),
      angles());
  ASSERT_TRUE(step);
  EXPECT_EQ(step->stop, 7U);
  EXPECT_NEAR(step->tilt, 0.005, radians_from_degrees(0.02));
  EXPECT_NEAR(step->height, -0.0008, 2e-5);
  const auto bump = find_bump(*step);
  ASSERT_TRUE(bump);
  EXPECT_EQ(bump->code, "moved");
  EXPECT_EQ(bump->detail,
            "between stops 6 and 7 the sensor moved: the platform tilts by 0.3 degrees and sinks "
            "by 0.8 mm as it sees it");
  const Parameters& values = bump->parameters;
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values.at("from_stop"), Parameters::mapped_type(6.0));
  EXPECT_EQ(values.at("to_stop"), Parameters::mapped_type(7.0));
  EXPECT_NEAR(std::get<double>(values.at("tilt_deg")), 0.3, 0.05);
  EXPECT_NEAR(std::get<double>(values.at("sink_mm")), 0.8, 0.05);
}

TEST(SensorStep, IsNoneOfARigThatStandsFirm) {
  const auto step = solve_sensor_step(planes([](std::size_t) { return StopPlane{}; }), angles());
  ASSERT_TRUE(step);
  EXPECT_FALSE(find_bump(*step));
}

TEST(SensorStep, IsNoneOfASensorThatWarmsUp) {
  const auto step =
      solve_sensor_step(planes([](std::size_t stop) {
                          return StopPlane{.height = 0.0002 * static_cast<double>(stop)};
                        }),
                        angles());
  ASSERT_TRUE(step);
  EXPECT_GT(step->size, 0.0005);  // large enough to be reported if it were sudden
  EXPECT_FALSE(find_bump(*step));
}

TEST(SensorStep, IsSkippedWithoutVisiblePlatform) { EXPECT_FALSE(solve_sensor_step({}, angles())); }

}  // namespace
}  // namespace octurn
