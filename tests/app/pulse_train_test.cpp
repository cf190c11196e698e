#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include "app/quick_motion.hpp"
#include "turntable/motion.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using Time = PulseTrain::Time;
using Duration = Time::duration;

const Time start = Time(1000s);

/// The changes of the line on a system whose delays a test sets.
struct PulseChanges {
  std::vector<PulseTrain::Change> changes = {};  // `due` is the time of the change
  LatePulses late = {};

  std::vector<Time> rises() const {
    std::vector<Time> times;
    for (const PulseTrain::Change& change : changes) {
      if (change.high) {
        times.push_back(change.due);
      }
    }
    return times;
  }
};

PulseChanges changes_of(const Motion& motion, int steps,
                        const std::function<Duration(std::size_t)>& delay_of_change) {
  PulseChanges line;
  Time now = start;
  PulseTrain train(motion, steps, now);
  while (const auto change = train.next()) {
    now = std::max(now, change->due) + delay_of_change(line.changes.size());
    line.changes.push_back({.high = change->high, .due = now});
    train.done(now);
  }
  line.late = train.late();
  return line;
}

Duration punctual(std::size_t) { return 0s; }

TEST(PulseTrain, RaisesTheLineOnceForEachStepAndLeavesItLow) {
  const PulseChanges line = changes_of(quick_motion, 800, punctual);
  ASSERT_EQ(line.changes.size(), 1600U);
  for (std::size_t i = 0; i < 1600; ++i) {
    EXPECT_EQ(line.changes[i].high, i % 2 == 0);
  }
}

TEST(PulseTrain, HasNothingToDoForNoSteps) {
  EXPECT_TRUE(changes_of({}, 0, punctual).changes.empty());
}

TEST(PulseTrain, TakesTheTimeOfItsRamps) {
  const PulseChanges line = changes_of(quick_motion, 800, punctual);
  // 0.3 s of acceleration, 500 steps at 800 steps/s, 0.3 s of deceleration; each step is rounded up
  // to a nanosecond.
  const Duration taken = line.rises().back() - start;
  EXPECT_GE(taken, 1225ms);
  EXPECT_LE(taken, 1225ms + 800ns);
  EXPECT_EQ(line.late.count, 0);
}

TEST(PulseTrain, DoubtsAMoveWhosePulseCameAnEighthOfAPeriodLate) {
  // At 200 steps/s an eighth of a period, 2 of 16 quarter steps, takes 10 ms.
  const Motion steady = {.start_steps_per_second = 200, .top_steps_per_second = 200};
  const auto late_by = [](Duration delay) {
    return [delay](std::size_t change) { return change == 40 ? delay : Duration(0); };
  };
  EXPECT_FALSE(changes_of(steady, 100, late_by(9ms)).late.may_have_lost_steps);
  EXPECT_TRUE(changes_of(steady, 100, late_by(11ms)).late.may_have_lost_steps);
}

TEST(PulseTrain, KeepsEachLevelLongEnoughForTheDriver) {
  const Motion fast = {.start_steps_per_second = 5000, .top_steps_per_second = 5000};
  std::mt19937 random(1);
  const auto delays = [&](std::size_t) { return Duration(random() % 2'000'000); };
  const PulseChanges line = changes_of(fast, 2000, delays);
  ASSERT_EQ(line.changes.size(), 4000U);
  for (std::size_t i = 1; i < line.changes.size(); ++i) {
    // A4988 datasheet: STEP stays high and low for at least 1 us.
    EXPECT_GE(line.changes[i].due - line.changes[i - 1].due, 1us) << i;
  }
}

TEST(PulseTrain, NeverCatchesUp) {
  std::mt19937 random(2);
  Duration delayed = {};
  const auto delays = [&](std::size_t) {
    const Duration delay = random() % 10 == 0 ? Duration(random() % 30'000'000) : Duration(0);
    delayed += delay;
    return delay;
  };
  const std::vector<Time> rises = changes_of(quick_motion, 800, delays).rises();
  const std::vector<Time> undelayed = changes_of(quick_motion, 800, punctual).rises();

  ASSERT_EQ(rises.size(), undelayed.size());
  ASSERT_GT(delayed, 1s);  // there was a delay to catch up with
  for (std::size_t i = 1; i < rises.size(); ++i) {
    EXPECT_GE(rises[i] - rises[i - 1], undelayed[i] - undelayed[i - 1]) << i;
  }
}

TEST(PulseTrain, StartsSlowlyAgainAfterAStandstill) {
  // Pulse 400, at full speed, is delayed by more than a step takes at the starting speed.
  const auto delay = [](std::size_t change) { return change == 800 ? Duration(50ms) : 0ms; };
  const std::vector<Time> rises = changes_of(quick_motion, 800, delay).rises();
  const Duration first = rises[0] - start;
  EXPECT_NEAR(static_cast<double>((rises[401] - rises[400]).count()),
              static_cast<double>(first.count()), 1);  // ns, rounding
  EXPECT_NEAR(static_cast<double>((rises[400] - rises[399]).count()), 51.25e6, 1);
}

TEST(PulseTrain, StartsSlowlyAgainAfterALevelThatWasLate) {
  const auto delay = [](std::size_t change) { return change == 801 ? Duration(50ms) : 0ms; };
  const PulseChanges line = changes_of(quick_motion, 800, delay);
  const std::vector<Time> rises = line.rises();
  EXPECT_GT(rises[402] - rises[401], 4ms);  // a step takes 5 ms at first, 1.25 ms at full speed
  EXPECT_EQ(line.late.count, 1);
}

TEST(PulseTrain, CountsLatePulsesAndTellsTheWorst) {
  const auto delay = [](std::size_t change) {
    return change == 100 ? Duration(2ms) : change == 700 ? Duration(7ms) : Duration(100us);
  };
  const LatePulses late = changes_of(quick_motion, 800, delay).late;
  EXPECT_EQ(late.count, 2);
  EXPECT_EQ(late.longest, 7ms);
}

}  // namespace
}  // namespace octurn
