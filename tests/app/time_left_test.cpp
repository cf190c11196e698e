#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "run/status_board.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;
using Clock = TimeLeft::Clock;

constexpr ScanEstimate expected{.stop = 1s, .build = 6s, .is_measured = true};

Clock::time_point at(double seconds) {
  return Clock::time_point() + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

/// The remaining seconds as estimated; negative without an estimate.
double left(const TimeLeft& time, double now) {
  return time.expected() ? time.expected()->left(at(now)).count() : -1;
}

/// The durations of a whole scan.
struct Course {
  int stops = 36;
  std::function<double(int stop)> stop = {};  // seconds
  double build = 6;                           // seconds
};

/// Simulates a scan and asks for an estimate ten times a stop.
/// @param tell  called with the true and the estimated remaining seconds and the snapshots so far
void follow(const Course& course, const ScanEstimate& before,
            const std::function<void(double truth, double told, int snapshots)>& tell) {
  std::vector<double> ends;
  double total = 0;
  for (int stop = 0; stop <= course.stops; ++stop) {  // including the last look
    total += course.stop(stop);
    ends.push_back(total);
  }
  total += course.build;
  TimeLeft time(before, course.stops, 0, at(0));
  double now = 0;
  const auto ask_until = [&](double end, int snapshots) {
    for (int part = 0; part < 10; ++part) {
      const double then = now + (end - now) * part / 10;
      tell(total - then, left(time, then), snapshots);
    }
    now = end;
  };
  for (int stop = 0; stop <= course.stops; ++stop) {
    ask_until(ends[static_cast<std::size_t>(stop)], stop);
    time.count(std::min(stop + 1, course.stops), at(now));
  }
  time.begin_model(at(now));
  ask_until(total, course.stops);
}

/// Expects that from the third snapshot on the estimate is within a quarter and half a second of
/// the truth, and that it never rises by more than a tenth.
void expect_honest(const Course& course, const ScanEstimate& before) {
  double last = -1;
  follow(course, before, [&](double truth, double told, int snapshots) {
    if (snapshots >= 3) {
      ASSERT_GE(told, 0);
      EXPECT_NEAR(told, truth, 0.25 * truth + 0.5) << snapshots << " snapshots";
    }
    if (last >= 0) {
      EXPECT_LE(told, 1.1 * last + 1e-9) << snapshots << " snapshots";
    }
    last = told;
  });
}

TEST(TimeLeft, IsHonestOnARigThatIsFastOneAsLifeAndOneWithASlowDisk) {
  const Course life{.stop = [](int stop) { return stop == 0 ? 2.0 : 0.85; }};
  expect_honest(life, {.stop = 890ms, .build = 6s, .is_measured = true});
  const Course fast{.stop = [](int) { return 0.05; }, .build = 1};
  expect_honest(fast, {.stop = 50ms, .build = 1s, .is_measured = true});
  const Course slow_disk{.stop = [](int stop) { return stop % 4 == 3 ? 3.0 : 1.6; }, .build = 8};
  expect_honest(slow_disk, {.stop = 2s, .build = 8s, .is_measured = true});
}

TEST(TimeLeft, IsToldFromTheThirdStopOnWhereNothingWasMeasuredBefore) {
  const Course first{.stop = [](int stop) { return stop == 0 ? 4.0 : 1.0; }, .build = 2};
  const ScanEstimate guessed{.stop = 10s, .build = 2s};
  follow(first, guessed, [&](double, double told, int snapshots) {
    EXPECT_EQ(told < 0, snapshots < 3) << snapshots;
  });
  expect_honest(first, guessed);
}

TEST(TimeLeft, BeginsWithWhatEarlierScansTookAndKeepsBuildingInIt) {
  TimeLeft time(expected, 10, 0, at(0));
  EXPECT_DOUBLE_EQ(left(time, 0), 11 + 6);
  EXPECT_DOUBLE_EQ(left(time, 0.5), 16.5);
  EXPECT_DOUBLE_EQ(left(time, 60), 10 + 6) << "a stop that lasts takes nothing from the others";
  time.begin_model(at(100));
  EXPECT_DOUBLE_EQ(left(time, 102), 4);
  time.count_model(0.5, at(100), at(102));
  EXPECT_DOUBLE_EQ(left(time, 102), 2);
}

TEST(TimeLeft, OfAScanThatGoesOnIsThatOfTheStopsThatRemain) {
  TimeLeft time(expected, 36, 18, at(0));
  EXPECT_DOUBLE_EQ(left(time, 0), 19 + 6);
}

TEST(TimeLeft, IsNotToldWhileADeviceFailsAndThenWithoutThatTime) {
  TimeLeft time(expected, 10, 0, at(0));
  for (int stop = 1; stop <= 4; ++stop) {
    time.count(stop, at(stop));
  }
  time.lose_pace();
  EXPECT_EQ(left(time, 20), -1);
  time.count(5, at(40));
  EXPECT_DOUBLE_EQ(left(time, 40), 6 + 6);
}

}  // namespace
}  // namespace octurn
