#include <gtest/gtest.h>

#include "core/calibrate/rendered_turn.hpp"

namespace octurn {
namespace {

TEST(Calibrate, GivesTheSameBitsForAnyNumberOfThreads) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.platform_from_sensor = wrong_pose({0.01, -0.005, 0.004}, {1, 0.4, 0}, 2);
  const CalibrationReport one = calibrate(turn, 1);
  const CalibrationReport four = calibrate(turn, 4);
  ASSERT_TRUE(one.accepted) << one.reason;
  EXPECT_EQ(one.platform_from_sensor.matrix(), four.platform_from_sensor.matrix());
  EXPECT_EQ(one.position_sigma, four.position_sigma);
  EXPECT_EQ(one.direction_sigma, four.direction_sigma);
  EXPECT_EQ(one.before, four.before);
  EXPECT_EQ(one.after, four.after);
  EXPECT_EQ(one.stop_offsets, four.stop_offsets);
}

}  // namespace
}  // namespace octurn
