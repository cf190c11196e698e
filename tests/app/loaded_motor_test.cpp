#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "app/quick_motion.hpp"
#include "octurn/units.hpp"
#include "turntable/motion.hpp"
#include "turntable/simulated_turntable.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {
namespace {

/// What happens on the way of a move.
struct Incident {
  int stop_after = 0;  ///< the pulse after which a stop is requested; 0: none
  int late_pulse = 0;  ///< the pulse that comes late; 0: none
  double late_by = 0;  ///< seconds
};

/// A move's effect on the platform, in degrees.
struct Outcome {
  double lost = 0;       ///< how far the platform rests from where the pulses count it
  double swing = 0;      ///< peak to peak, in the 10 frames after the time to settle
  double swung_for = 0;  ///< seconds from the last pulse until it stood
  bool doubted = false;  ///< whether the pulses came so late that steps may be lost
};

constexpr double seconds_of_frames = 0.33;

/// Moves a platform by the pulses that `Stepper` makes, in simulated time.
Outcome outcome_of(const PlatformLoad& load, const Motion& motion, int steps,
                   const Incident& incident = {}) {
  using Time = PulseTrain::Time;
  const auto to_time = [](double seconds) {
    return Time(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds)));
  };
  LoadedMotor platform(load);
  PulseTrain train(motion, steps, Time());
  Time now = {};
  int pulses = 0;
  while (const auto change = train.next()) {
    if (change->high && incident.stop_after > 0 && pulses >= incident.stop_after &&
        !train.brake()) {
      break;
    }
    const bool is_late = change->high && pulses + 1 == incident.late_pulse;
    const Time time =
        change->due + (is_late ? to_time(incident.late_by) : Time()).time_since_epoch();
    platform.advance(std::chrono::duration<double>(time - now).count());
    now = time;
    if (change->high) {
      platform.set_field(2 * std::numbers::pi * ++pulses / motion.steps_per_turn);
    }
    train.done(time);
  }
  Outcome outcome;
  const double settling = std::chrono::duration<double>(motion.settle_time).count();
  double low = 1e9;
  double high = -1e9;
  for (double time = 0; time < 5; time += 1e-3) {
    platform.advance(1e-3);
    if (time >= settling && time < settling + seconds_of_frames) {
      low = std::min(low, platform.angle());
      high = std::max(high, platform.angle());
    }
    outcome.swung_for = platform.is_at_rest() ? outcome.swung_for : time;
  }
  outcome.swing = degrees_from_radians(high - low);
  outcome.doubted = train.late().may_have_lost_steps;
  outcome.lost = degrees_from_radians(platform.lag());
  return outcome;
}

constexpr double kept = 0.3;  // degrees; friction holds the platform up to 0.12 beside its place

TEST(LoadedMotor, RestsWhereTheFieldIsExceptForFriction) {
  LoadedMotor platform({.friction = 0});
  platform.set_field(0.01);
  double highest = 0;
  double lowest = 1;
  for (double time = 0; time < 1; time += 1e-3) {
    platform.advance(1e-3);
    highest = std::max(highest, platform.angle());
    lowest = time > 0.05 ? std::min(lowest, platform.angle()) : lowest;
  }
  EXPECT_NEAR(highest, 0.02, 1e-3) << "an undamped swing goes as far beyond";
  EXPECT_NEAR(lowest, 0, 2e-3);
}

TEST(LoadedMotor, SwingsAsFastAsItsMagneticSpringAndInertiaHaveIt) {
  // f = sqrt(N T / J) / (2 pi) = 7.1 Hz for 50 periods a turn, 0.2 N m and 0.005 kg m^2.
  LoadedMotor platform({.friction = 0, .damping = 0, .rotor_inertia = 0});
  platform.set_field(1e-3);
  int crossings = 0;
  bool is_beyond = false;
  constexpr double seconds = 10;
  for (double time = 0; time < seconds; time += 1e-3) {
    platform.advance(1e-3);
    crossings += (platform.lag() < 0) != is_beyond ? 1 : 0;
    is_beyond = platform.lag() < 0;
  }
  EXPECT_NEAR(crossings / 2.0 / seconds, std::sqrt(50 * 0.2 / 0.005) / (2 * std::numbers::pi), 0.1);
}

TEST(LoadedMotor, IsHeldByFrictionThatTheTorqueCannotMove) {
  LoadedMotor platform({.holding_torque = 0.2, .friction = 0.3});
  platform.set_field(0.02);
  platform.advance(1);
  EXPECT_EQ(platform.angle(), 0);
  EXPECT_TRUE(platform.is_at_rest());
}

TEST(LoadedMotor, LosesWholePeriods) {
  const double period = degrees_from_radians(LoadedMotor(PlatformLoad{}).period());
  EXPECT_NEAR(period, 7.2, 1e-9);
  // The speeds of Octurn 0.1, which were too quick for the parts that it named.
  const double lost = outcome_of({}, quick_motion, 22).lost;
  EXPECT_GT(std::abs(lost), kept);
  EXPECT_NEAR(lost / period, std::round(lost / period), kept / period);
}

TEST(LoadedMotor, DoesNotCareAboutTheLengthOfACall) {
  LoadedMotor once(PlatformLoad{});
  LoadedMotor often(PlatformLoad{});
  once.set_field(0.05);
  often.set_field(0.05);
  once.advance(0.2);
  for (int i = 0; i < 400; ++i) {
    often.advance(0.0005);
  }
  EXPECT_NEAR(once.angle(), often.angle(), 1e-4);
}

/// The table of docs/wiring.md, by holding torque, N m.
class DefaultMotion : public ::testing::TestWithParam<double> {
 protected:
  /// Calls `check` with each disc on the shaft and behind a gear, and the default motion.
  template <typename Check>
  void with_each_platform(Check check) const {
    for (const double inertia : {0.002, 0.005, 0.009, 0.013}) {
      for (const double gear_ratio : {1.0, 4.0}) {
        SCOPED_TRACE(std::to_string(inertia) + " kg m^2, " + std::to_string(gear_ratio));
        check(
            PlatformLoad{
                .holding_torque = GetParam(), .inertia = inertia, .gear_ratio = gear_ratio},
            to_motion({.gear_ratio = gear_ratio}));
      }
    }
  }
};

TEST_P(DefaultMotion, LosesNoStep) {
  with_each_platform([](const PlatformLoad& load, const Motion& motion) {
    for (const int steps : {1, 4, 22, 100, 800}) {
      const Outcome outcome = outcome_of(load, motion, steps);
      EXPECT_NEAR(outcome.lost, 0, kept) << steps;
      EXPECT_LT(outcome.swung_for, 0.75) << steps;
      if (load.inertia <= 0.005) {
        EXPECT_EQ(outcome.swing, 0) << steps << ": the documented parts stand after settle_ms";
      }
    }
  });
}

TEST_P(DefaultMotion, LosesNoStepWhereItIsStopped) {
  with_each_platform([](const PlatformLoad& load, const Motion& motion) {
    for (const int stop_after : {1, 5, 30, 200, 400, 790}) {
      EXPECT_NEAR(outcome_of(load, motion, 800, {.stop_after = stop_after}).lost, 0, kept)
          << stop_after;
    }
  });
}

TEST_P(DefaultMotion, DoubtsEachLatePulseThatLosesSteps) {
  int lost = 0;
  with_each_platform([&lost](const PlatformLoad& load, const Motion& motion) {
    for (const double late_by : {0.005, 0.015, 0.04}) {
      for (const int late_pulse : {1, 2, 5, 10, 50, 100, 300, 700, 795}) {
        const Outcome outcome =
            outcome_of(load, motion, 800, {.late_pulse = late_pulse, .late_by = late_by});
        if (std::abs(outcome.lost) > kept) {
          ++lost;
          EXPECT_TRUE(outcome.doubted) << late_pulse << ", " << late_by;
        }
      }
    }
  });
  EXPECT_EQ(lost, GetParam() == 0.2 ? 5 : 0) << "as in docs/wiring.md";
}

INSTANTIATE_TEST_SUITE_P(Torques, DefaultMotion, ::testing::Values(0.2, 0.4, 0.88));

}  // namespace
}  // namespace octurn
