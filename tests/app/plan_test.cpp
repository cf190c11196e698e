#include "capture/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/thrown_error.hpp"

namespace octurn {
namespace {

TEST(Plan, DividesATurnThatDividesEvenly) {
  EXPECT_EQ(stop_positions(0, 800, 8),
            (std::vector<std::int64_t>{0, 100, 200, 300, 400, 500, 600, 700}));
}

TEST(Plan, StopsAtTheNearestMicrostepWhereItDoesNot) {
  // 800 / 3 = 266.67 and 533.33; 800 / 64 = 12.5, which is rounded up.
  EXPECT_EQ(stop_positions(0, 800, 3), (std::vector<std::int64_t>{0, 267, 533}));
  EXPECT_EQ(stop_positions(0, 800, 64)[1], 13);
  EXPECT_EQ(stop_positions(0, 800, 64)[2], 25);
}

TEST(Plan, SumsToOneTurnExactly) {
  for (const int steps : {200, 800, 3200, 12345}) {
    for (int stops = 1; stops <= std::min(steps, 800); ++stops) {
      const std::vector<std::int64_t> positions = stop_positions(0, steps, stops);
      ASSERT_EQ(positions.size(), static_cast<std::size_t>(stops));
      EXPECT_EQ(positions.front(), 0);
      for (int stop = 0; stop < stops; ++stop) {
        const double exact = static_cast<double>(stop) * steps / stops;
        EXPECT_LE(std::abs(static_cast<double>(positions[static_cast<std::size_t>(stop)]) - exact),
                  0.5 + 1e-9);
      }
    }
  }
}

TEST(Plan, HasAStepForEachStop) {
  EXPECT_EQ(stop_positions(0, 200, 200).back(), 199);
  const Error error = error_thrown_by([] { stop_positions(0, 200, 201); });
  EXPECT_EQ(error.code(), ErrorCode::bad_settings);
  EXPECT_STREQ(error.what(),
               "a turn of the platform has 200 steps, and 201 snapshots are asked for");
}

TEST(Plan, BeginsAtTheNextWholeTurnSoThatThePlatformTurnsOneWay) {
  EXPECT_EQ(stop_positions(700, 800, 2), (std::vector<std::int64_t>{800, 1200}));
  EXPECT_EQ(stop_positions(800, 800, 2), (std::vector<std::int64_t>{800, 1200}));
  EXPECT_EQ(stop_positions(-100, 800, 2), (std::vector<std::int64_t>{0, 400}));
}

TEST(Plan, GoesOnAtTheNextStopWhereverThePlatformStands) {
  const std::vector<std::int64_t> last_two{400, 600};
  for (const std::int64_t position : {201, 310, 400}) {
    EXPECT_EQ(stop_positions(position, 800, 4, 2), last_two) << position;
  }
  EXPECT_EQ(stop_positions(401, 800, 4, 2), (std::vector<std::int64_t>{1200, 1400}));
  EXPECT_EQ(stop_positions(-400, 800, 4, 2), (std::vector<std::int64_t>{-400, -200}));
  EXPECT_EQ(stop_positions(0, 800, 4, 3), (std::vector<std::int64_t>{600}));
  EXPECT_TRUE(stop_positions(0, 800, 4, 4).empty());
}

// A month of turning with the finest resolution: 1000 full steps, 16 microsteps, a gear of 1000
// : 1.
TEST(Plan, GoesOnAfterMoreTurnsThanFitInto32Bits) {
  constexpr int steps = 16'000'000;
  constexpr std::int64_t home = std::int64_t{100'000} * steps;
  EXPECT_EQ(
      stop_positions(home - 1, steps, 4),
      (std::vector<std::int64_t>{home, home + 4'000'000, home + 8'000'000, home + 12'000'000}));
  EXPECT_EQ(angle_deg_at(home + 4'000'000, steps), 90.0);
}

TEST(Plan, TellsTheAngleOfAPosition) {
  EXPECT_EQ(angle_deg_at(0, 800), 0.0);
  EXPECT_EQ(angle_deg_at(200, 800), 90.0);
  EXPECT_EQ(angle_deg_at(267, 800), 120.15);
  EXPECT_EQ(angle_deg_at(1000, 800), 90.0);
  EXPECT_EQ(angle_deg_at(-200, 800), 270.0);
}

TEST(Plan, FindsThePositionOfEveryAngleAgain) {
  for (const int steps : {200, 800, 3200, 799, 57600}) {
    for (int position = 0; position < steps; ++position) {
      ASSERT_EQ(position_at(angle_deg_at(position, steps), steps), position) << steps;
    }
  }
  EXPECT_EQ(position_at(-90, 800), 600);
  EXPECT_EQ(position_at(450, 800), 200);
}

}  // namespace
}  // namespace octurn
