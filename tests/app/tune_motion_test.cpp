#include <gtest/gtest.h>

#include "app/simulated_frames.hpp"
#include "doctor/turn_checks.hpp"

namespace octurn {
namespace {

constexpr double speed = 20;

const PlatformLook look{.intrinsics = {},
                        .platform_from_sensor = nominal_platform_from_sensor(),
                        .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}}};

MotionLimits limits_of(const PlatformLoad& load) {
  Rig rig({.sensor_uri = simulation_uri({.speed = speed}), .speed = speed, .load = load});
  return find_motion_limits(rig, look, 1, {}, {});
}

TEST(FindMotionLimits, FindsAMarginInTheDocumentedParts) {
  const MotionLimits limits = limits_of({});
  ASSERT_TRUE(limits.fastest);
  EXPECT_GE(pace_with_margin(*limits.fastest), 0.99);
}

TEST(FindMotionLimits, SlowsAWeakMotorWithAHeavyDiscDown) {
  const MotionLimits limits = limits_of({.holding_torque = 0.05, .inertia = 0.013});
  ASSERT_TRUE(limits.fastest);
  ASSERT_TRUE(limits.lost_at);
  EXPECT_LT(*limits.fastest, 1);
  EXPECT_GT(*limits.lost_at, *limits.fastest);
}

TEST(FindMotionLimits, FindsNoneWhereTheMotorCannotMoveThePlatform) {
  EXPECT_FALSE(limits_of({.holding_torque = 0.2, .friction = 0.3}).fastest);
}

}  // namespace
}  // namespace octurn
