#include "turntable/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "app/quick_motion.hpp"
#include "turntable/stepper_settings.hpp"

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

/// A platform on the shaft of a stepper: the rotor follows the field by T sin(N (field - rotor)),
/// N = 50 pole pairs of a motor of 1.8 degrees, and lags or loses a period of the field, 360 / N
/// degrees (Acarnley, Stepping Motors, chapter 4).
struct LoadedMotor {
  double holding_torque = 0.2;  ///< N m
  double inertia = 0.005;       ///< kg m^2; a disc of 28 cm of birch ply, 12 mm thick
  double friction = 0.02;       ///< N m
  double damping = 1e-3;        ///< N m s

  /// Moves by `steps` of the profile, and waits until the platform stands.
  /// @param stop_after  step after which it is asked to stop; 0: never
  /// @return how far the platform is from where the pulses count it, degrees
  double lost_deg(const Motion& motion, int steps, int stop_after = 0) const {
    constexpr double dt = 2e-5;
    constexpr double settling = 4;
    const double step = 2 * std::numbers::pi / motion.steps_per_turn;
    SpeedProfile profile(motion, steps);
    double field = 0;
    double rotor = 0;
    double speed = 0;
    double pulse = profile.next_step();
    int made = 0;
    bool is_moving = true;
    for (double time = 0; is_moving || time < pulse + settling; time += dt) {
      if (is_moving && time >= pulse) {
        field += step;
        const bool stops = stop_after > 0 && ++made >= stop_after;
        is_moving = profile.steps_left() > 0 && (!stops || profile.brake());
        pulse += is_moving ? profile.next_step() : 0;
      }
      const double torque = holding_torque * std::sin(50 * (field - rotor)) - damping * speed -
                            friction * std::tanh(speed / 0.01);
      speed += torque / inertia * dt;
      rotor += speed * dt;
    }
    return (field - rotor) * 180 / std::numbers::pi;
  }
};

constexpr double kept = 1;  // degree; friction holds the platform a little beside its place

TEST(SpeedProfile, LosesNothingByDefaultWithAPlatformOnTheShaft) {
  for (const double inertia : {0.0001, 0.002, 0.005}) {
    const LoadedMotor motor{.inertia = inertia};
    for (const int steps : {1, 4, 22, 100, 800}) {
      EXPECT_NEAR(motor.lost_deg(to_motion({}), steps), 0, kept) << inertia << ", " << steps;
    }
  }
}

TEST(SpeedProfile, LosesNothingWhereAMoveIsStopped) {
  for (const double inertia : {0.002, 0.005}) {
    for (const int stop_after : {1, 5, 30, 200, 400, 790}) {
      EXPECT_NEAR(LoadedMotor{.inertia = inertia}.lost_deg(to_motion({}), 800, stop_after), 0, kept)
          << inertia << ", " << stop_after;
    }
  }
}

TEST(SpeedProfile, LosesStepsWhereItIsTooQuickForThePlatform) {
  EXPECT_GT(std::abs(LoadedMotor{}.lost_deg(quick_motion, 22)), 7) << "a period of the field";
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

TEST(SpeedProfile, EndsAtOnceWhileItIsSlow) {
  SpeedProfile profile({.start_steps_per_second = 200, .top_steps_per_second = 200}, 800);
  profile.next_step();
  EXPECT_FALSE(profile.brake());
}

}  // namespace
}  // namespace octurn
