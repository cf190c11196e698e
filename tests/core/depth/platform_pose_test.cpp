#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr double tolerance = 1e-12;  // metres; a few roundings of a double below one metre

TEST(ObjectFromSensor, IsTheCalibrationBeforeThePlatformTurns) {
  const Eigen::Isometry3d platform_from_sensor =
      Eigen::Translation3d(0.1, -0.9, 0.4) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX());

  EXPECT_TRUE(object_from_sensor(platform_from_sensor, 0.0).isApprox(platform_from_sensor));
}

TEST(ObjectFromSensor, TurnsBackWhatThePlatformTurned) {
  // A mark on the object at +X stands at +Y once the platform has turned a quarter
  // counter-clockwise.
  const Eigen::Vector3d mark_on_object(0.1, 0.0, 0.05);
  const Eigen::Vector3d mark_in_platform(0.0, 0.1, 0.05);
  const double quarter_turn = std::numbers::pi / 2;

  const Eigen::Isometry3d object_from_platform =
      object_from_sensor(Eigen::Isometry3d::Identity(), quarter_turn);

  EXPECT_LT((object_from_platform * mark_in_platform - mark_on_object).norm(), tolerance);
}

TEST(ObjectFromSensor, MovesTheSensorRoundTheObjectAgainstThePlatform) {
  // The sensor stands at -Y, 0.9 m away and 0.4 m up. Seen from an object that turned by 30 degrees
  // counter-clockwise, it went round by 30 degrees clockwise, at the same distance and height.
  const Eigen::Isometry3d platform_from_sensor(Eigen::Translation3d(0.0, -0.9, 0.4));
  const double angle = std::numbers::pi / 6;

  const Eigen::Vector3d eye =
      object_from_sensor(platform_from_sensor, angle) * Eigen::Vector3d::Zero();

  EXPECT_NEAR(eye.x(), -0.9 * std::sin(angle), tolerance);
  EXPECT_NEAR(eye.y(), -0.9 * std::cos(angle), tolerance);
  EXPECT_NEAR(eye.z(), 0.4, tolerance);
}

}  // namespace
}  // namespace octurn
