#include "turntable/motion.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "app/quick_motion.hpp"

namespace octurn {
namespace {

std::vector<double> step_times(const Motion& motion, int steps) {
  std::vector<double> times;
  SpeedProfile profile(motion, steps);
  while (profile.steps_left() > 0) {
    times.push_back(profile.next_step());
  }
  return times;
}

TEST(SpeedProfile, TakesTheTimeOfEvenAccelerationAndItsMirrorImage) {
  // From 200 to 800 steps/s at 2000 steps/s^2: 150 steps in 0.3 s, twice; 500 steps at 800 steps/s.
  EXPECT_NEAR(move_time(quick_motion, 800), 0.3 + 500.0 / 800 + 0.3, 1e-9);
}

TEST(SpeedProfile, TurnsAShortMoveRoundInTheMiddle) {
  // 50 steps from rest at 400 steps/s^2 take 0.5 s, as do the 50 steps down to rest.
  const Motion motion = {
      .start_steps_per_second = 0, .top_steps_per_second = 800, .ramp_steps_per_second2 = 400};
  EXPECT_NEAR(move_time(motion, 100), 1, 1e-9);
  const auto times = step_times(motion, 100);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_NEAR(times[i], times[99 - i], 1e-9) << i;
  }
}

TEST(SpeedProfile, IsNeverFasterThanTheTopSpeed) {
  const std::vector<double> times =
      step_times({.start_steps_per_second = 900, .top_steps_per_second = 800}, 800);
  ASSERT_EQ(times.size(), 800U);
  for (const double time : times) {
    EXPECT_GE(time, 1.0 / 800);
  }
}

TEST(SpeedProfile, GainsAgainWhatItLost) {
  SpeedProfile profile(quick_motion, 800);
  for (int i = 0; i < 300; ++i) {
    profile.next_step();
  }
  profile.slowed_to(1.0 / 600);  // seconds per step

  // v^2 = 600^2 + 2 * 2000 s: back at 800 steps/s after 70 steps.
  double time = 0;
  for (int i = 0; i < 70; ++i) {
    time += profile.next_step();
  }
  EXPECT_NEAR(time, (800.0 - 600) / 2000, 1e-9);
  EXPECT_NEAR(profile.next_step(), 1.0 / 800, 1e-12);
}

TEST(SpeedProfile, StartsAgainAfterAStandstill) {
  SpeedProfile profile(quick_motion, 800);
  const double first = profile.next_step();
  for (int i = 0; i < 300; ++i) {
    profile.next_step();
  }
  profile.slowed_to(3);
  EXPECT_NEAR(profile.next_step(), first, 1e-12);
}

TEST(SpeedProfile, BrakesAsItGainedSpeed) {
  SpeedProfile profile(quick_motion, 800);
  double speed = 0;
  for (int i = 0; i < 100; ++i) {
    speed = 1 / profile.next_step();
  }
  EXPECT_TRUE(profile.brake());
  // v^2 = v0^2 + 2 a s: 100 steps at 2,000 steps/s^2 from 200 steps/s.
  EXPECT_EQ(profile.steps_left(), 100);
  while (profile.steps_left() > 0) {
    EXPECT_TRUE(profile.brake()) << "again and again";
    const double next = 1 / profile.next_step();
    EXPECT_LE(next, speed + 3);
    speed = next;
  }
  EXPECT_NEAR(speed, 200, 6);
}

TEST(Motion, AtHalfThePaceTakesTwiceAsLongEverywhere) {
  const Motion paced = at_pace(quick_motion, 0.5);
  for (const int steps : {1, 22, 800}) {
    EXPECT_NEAR(move_time(paced, steps), 2 * move_time(quick_motion, steps), 1e-9) << steps;
  }
  EXPECT_EQ(paced.steps_per_turn, quick_motion.steps_per_turn);
}

TEST(SpeedProfile, EndsAtOnceWhileItIsSlow) {
  SpeedProfile profile({.start_steps_per_second = 200, .top_steps_per_second = 200}, 800);
  profile.next_step();
  EXPECT_FALSE(profile.brake());
}

// A rotor without a platform would follow these speeds (docs/wiring.md).
TEST(MoveTime, OfAWholeScanIsAtMostTwentyFiveSecondsMoreThanABareRotors) {
  const Motion bare{
      .start_steps_per_second = 200, .top_steps_per_second = 800, .ramp_steps_per_second2 = 2000};
  const auto scan_time = [](const Motion& motion) {
    return 28 * move_time(motion, 22) + 8 * move_time(motion, 23);  // 36 stops, 800 steps
  };
  EXPECT_LE(scan_time({}) - scan_time(bare), 25);
}

}  // namespace
}  // namespace octurn
