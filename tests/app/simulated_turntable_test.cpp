#include "turntable/simulated_turntable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <thread>
#include <vector>

#include "app/quick_motion.hpp"

namespace octurn {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double step = 2 * std::numbers::pi / 800;

/// The angles that a move reports, in steps: one every 10 ms.
std::vector<double> steps_told(int position, const Motion& motion) {
  std::vector<double> told;
  SimulatedTurntable turntable([&](double angle) { told.push_back(angle / step); }, 1, motion);
  EXPECT_TRUE(turntable.move_to(position, {}));
  return told;
}

TEST(SimulatedTurntable, TurnsToWholeStepsOfATurnOf800) {
  double angle = -1;
  SimulatedTurntable turntable([&](double now) { angle = now; }, 100);
  EXPECT_EQ(turntable.steps_per_turn(), 800);
  EXPECT_EQ(turntable.position(), 0);

  EXPECT_TRUE(turntable.move_to(200, {}));
  EXPECT_EQ(turntable.position(), 200);
  EXPECT_NEAR(angle, std::numbers::pi / 2, 1e-12);

  EXPECT_TRUE(turntable.move_to(-3, {}));
  EXPECT_EQ(turntable.position(), -3);
  EXPECT_NEAR(angle, -3 * step, 1e-12);
}

TEST(SimulatedTurntable, TellsItsAngleAllTheWay) {
  Motion motion = quick_motion;
  motion.settle_time = milliseconds(0);
  const auto told = steps_told(200, motion);

  // From 200 to 800 steps/s at 2000 steps/s^2 and back: 100 steps in 0.2317 s, twice.
  ASSERT_EQ(told.size(), 48U);  // 47 during the move's 0.4633 s, and one at its end
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_GE(told[i], told[i - 1]);
    EXPECT_NEAR(told[i], std::round(told[i]), 1e-9);
  }
}

TEST(SimulatedTurntable, GainsAndLosesSpeedEvenly) {
  // 100 steps at 400 steps/s^2: the first half accelerates to 200 steps/s in 0.5 s, the second half
  // decelerates to rest.
  const auto told = steps_told(100, {.start_steps_per_second = 0,
                                     .top_steps_per_second = 1000,
                                     .ramp_steps_per_second2 = 400,
                                     .settle_time = milliseconds(0)});

  ASSERT_GE(told.size(), 100U);
  for (int i = 0; i < 99; ++i) {
    const double t = 0.01 * (i + 1);
    const double there = t < 0.5 ? 200 * t * t : 100 - 200 * (1 - t) * (1 - t);
    const double steps = told[static_cast<std::size_t>(i)];
    EXPECT_LE(steps, there + 1e-6) << t;
    EXPECT_GT(steps, there - 1 - 1e-6) << t;  // whole steps
  }
}

TEST(SimulatedTurntable, ReturnsOnlyWhenItHasSettled) {
  SimulatedTurntable turntable([](double) {}, 1, {.settle_time = milliseconds(150)});
  const auto begin = steady_clock::now();

  EXPECT_TRUE(turntable.move_to(1, {}));

  EXPECT_GE(steady_clock::now() - begin, milliseconds(150));
}

TEST(SimulatedTurntable, StopsOnTheWayAndKnowsWhereItStands) {
  std::stop_source stop;
  double last = 0;
  SimulatedTurntable turntable([&](double angle) {
    last = angle;
    if (angle > 40 * step) {
      stop.request_stop();
    }
  });

  EXPECT_FALSE(turntable.move_to(800, stop.get_token()));

  EXPECT_GT(turntable.position(), 40);
  EXPECT_LT(turntable.position(), 800);
  EXPECT_NEAR(last, static_cast<double>(turntable.position()) * step, 1e-12);
  const std::int64_t stopped_at = turntable.position();
  EXPECT_FALSE(turntable.move_to(800, stop.get_token()));  // the stop request still holds
  EXPECT_EQ(turntable.position(), stopped_at);
}

TEST(SimulatedTurntable, StopsWhileItSettles) {
  std::stop_source stop;
  SimulatedTurntable turntable([](double) {}, 1, {.settle_time = std::chrono::hours(1)});
  std::jthread stopper([&] { stop.request_stop(); });

  EXPECT_FALSE(turntable.move_to(1, stop.get_token()));
}

}  // namespace
}  // namespace octurn
