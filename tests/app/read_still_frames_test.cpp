#include <gtest/gtest.h>

#include <chrono>

#include "app/simulated_frames.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/units.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr double speed = 20;

const PlatformLook look_of_test{.intrinsics = {},
                                .platform_from_sensor = nominal_platform_from_sensor(),
                                .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}}};

/// @param noise  of the sensor, in times of a Kinect's; 0 where a test counts frames: with other
///               noise a swing is seen for longer, and a platform at rest seems to swing now and
///               then
RigOptions rig_with(const PlatformLoad& load, double noise) {
  return {
      .sensor_uri = simulation_uri({.noise = noise, .speed = speed}), .speed = speed, .load = load};
}

TEST(ReadStillFrames, WaitsForAHeavyPlatform) {
  Rig rig(rig_with({.inertia = 0.013, .friction = 0.005}, 0));
  const auto ignore = [](const DepthFrame&) {};
  ASSERT_TRUE(rig.turntable().move_to(22, {}));
  EXPECT_FALSE(is_swinging(look_of_test, read_still_frames(rig, look_of_test, 10, {}, ignore)));
  const int waited = rig.settling().frames();
  EXPECT_GT(waited, 0);

  // The next stop waits before its first frame, and needs no others.
  ASSERT_TRUE(rig.turntable().move_to(44, {}));
  EXPECT_FALSE(is_swinging(look_of_test, read_still_frames(rig, look_of_test, 10, {}, ignore)));
  EXPECT_LE(rig.settling().frames(), waited + 10);
}

TEST(ReadStillFrames, HardlyWaitsForTheDocumentedParts) {
  Rig rig(rig_with({}, 0));
  int waits = 0;
  for (int stop = 1; stop <= 5; ++stop) {
    ASSERT_TRUE(rig.turntable().move_to(22 * stop, {}));
    const int before = rig.settling().frames();
    read_still_frames(rig, look_of_test, 10, {}, [](const DepthFrame&) {});
    waits += rig.settling().frames() > before ? 1 : 0;
  }
  EXPECT_LE(waits, 1);
}

/// How far the platform is from where the position has it, degrees.
double lag_deg(Rig& rig) {
  const auto& turntable = dynamic_cast<SimulatedTurntable&>(rig.turntable());
  const double counted = 360.0 * static_cast<double>(turntable.position()) / 800;
  return counted - degrees_from_radians(turntable.angle());
}

TEST(TakeDepthImage, IsTakenAgainWhereALatePulseLostSteps) {
  Rig rig(rig_with({.inertia = 0.013}, 1));
  const ScanSettings settings;
  ASSERT_TRUE(take_depth_image(rig, {.index = 0, .position = 0}, settings, {}, {}));
  auto& turntable = dynamic_cast<SimulatedTurntable&>(rig.turntable());
  turntable.delay_pulse(23, std::chrono::milliseconds(150));

  ASSERT_TRUE(take_depth_image(rig, {.index = 1, .position = 66}, settings, {}, {}));

  EXPECT_EQ(turntable.late_pulses(), 1);
  EXPECT_EQ(turntable.position(), 66);
  EXPECT_NEAR(lag_deg(rig), 0, 0.3) << "two periods of 7.2 degrees were lost, and are made up for";
}

TEST(TakeDepthImage, IsKeptWhereALatePulseLostNone) {
  Rig rig(rig_with({}, 1));
  const ScanSettings settings;
  ASSERT_TRUE(take_depth_image(rig, {.index = 0, .position = 0}, settings, {}, {}));
  auto& turntable = dynamic_cast<SimulatedTurntable&>(rig.turntable());
  turntable.delay_pulse(10, std::chrono::milliseconds(40));

  int moves = 0;
  ScanObserver observer;
  observer.on_turn = [&moves](double) { ++moves; };
  ASSERT_TRUE(take_depth_image(rig, {.index = 1, .position = 22}, settings, {}, observer));

  EXPECT_EQ(moves, 1);
  EXPECT_NEAR(lag_deg(rig), 0, 0.3);
}

TEST(TakeDepthImage, SlowsAWeakMotorDownUntilItLosesNoStep) {
  Rig rig(rig_with({.holding_torque = 0.05, .inertia = 0.013}, 1));
  const ScanSettings settings;
  int slips = 0;
  ScanObserver observer;
  observer.on_slip = [&slips] { ++slips; };
  for (int stop = 0; stop < 6; ++stop) {
    ASSERT_TRUE(
        take_depth_image(rig, {.index = stop, .position = 22 * stop}, settings, {}, observer));
    EXPECT_NEAR(lag_deg(rig), 0, 0.6) << stop;
  }
  EXPECT_GT(slips, 0);
  EXPECT_LT(rig.pace(), 1);
}

TEST(TakeDepthImage, IsRefusedWhereTheMotorCannotMoveThePlatform) {
  Rig rig(rig_with({.friction = 0.3}, 1));
  const ScanSettings settings;
  ASSERT_TRUE(take_depth_image(rig, {.index = 0, .position = 0}, settings, {}, {}));
  EXPECT_EQ(code_thrown_by(
                [&] { take_depth_image(rig, {.index = 1, .position = 22}, settings, {}, {}); }),
            "turntable-failed");
}

}  // namespace
}  // namespace octurn
