#include "turntable/simulated_turntable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <thread>
#include <vector>

namespace octurn {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double step = 2 * std::numbers::pi / 800;

/// An angle that the platform was at, and when.
struct Sighting {
  double angle;
  double time;  // seconds from the start
};

std::vector<Sighting> sightings_of_a_move(int position, const Motion& motion) {
  std::vector<Sighting> sightings;
  const auto begin = steady_clock::now();
  SimulatedTurntable turntable(
      [&](double angle) {
        sightings.push_back({angle, duration<double>(steady_clock::now() - begin).count()});
      },
      1, motion);
  EXPECT_TRUE(turntable.move_to(position, {}));
  return sightings;
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
  const auto seen = sightings_of_a_move(200, {.settle_time = milliseconds(0)});

  ASSERT_GT(seen.size(), 15U);  // about one in 10 ms of half a second
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GE(seen[i].angle, seen[i - 1].angle);
    const double whole = seen[i].angle / step;
    EXPECT_NEAR(whole, std::round(whole), 1e-9);
  }
}

TEST(SimulatedTurntable, GainsAndLosesSpeedEvenly) {
  // 100 steps from rest at 400 steps/s^2: half of them up to 200 steps/s in 0.5 s, half down again.
  const auto seen = sightings_of_a_move(100, {.start_steps_per_second = 0,
                                              .top_steps_per_second = 1000,
                                              .ramp_steps_per_second2 = 400,
                                              .settle_time = milliseconds(0)});

  EXPECT_GE(seen.back().time, 1.0);
  int compared = 0;
  for (const Sighting& sighting : seen) {
    const double t = sighting.time;
    if (t >= 1) {
      continue;
    }
    const double there = t < 0.5 ? 200 * t * t : 100 - 200 * (1 - t) * (1 - t);
    // A step of rounding; and it was there a moment before it said so, at 200 steps/s at most.
    EXPECT_NEAR(sighting.angle / step, there, 1 + 200 * 0.05);
    EXPECT_LE(sighting.angle / step, there + 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 20);
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
  EXPECT_NEAR(last, turntable.position() * step, 1e-12);
  const int stopped_at = turntable.position();
  EXPECT_FALSE(turntable.move_to(800, stop.get_token()));  // still stopped: at most the first step
  EXPECT_LE(turntable.position() - stopped_at, 1);
}

TEST(SimulatedTurntable, StopsWhileItSettles) {
  std::stop_source stop;
  SimulatedTurntable turntable([](double) {}, 1, {.settle_time = std::chrono::hours(1)});
  std::jthread stopper([&] { stop.request_stop(); });

  EXPECT_FALSE(turntable.move_to(1, stop.get_token()));
}

}  // namespace
}  // namespace octurn
