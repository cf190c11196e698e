// The advice for a person who holds a board, and the choice of pictures. The board is simulated.

#include "calibration/board_watch.hpp"

#include <gtest/gtest.h>

#include "settings/laser_settings.hpp"
#include "simulator/waved_board.hpp"

namespace octurn {
namespace {

/// A camera of 820 x 616 pixels with lens distortion, and a board that is waved in front of it.
class BoardBeforeCamera {
 public:
  Picture picture(int number) const { return board_.picture(number); }
  const LaserSimulation& truth() const { return simulation_; }

 private:
  static LaserSimulation other_lens() {
    LaserSimulation simulation{.lens = LaserSettings{}.lens, .k1 = -0.06, .k2 = 0.02};
    simulation.lens.fx *= 1.012;
    simulation.lens.cx += 5;
    return simulation;
  }

  LaserSimulation simulation_ = other_lens();
  WavedBoard board_{simulation_};
};

Picture grey(const Intrinsics& lens) {
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  return {
      .width = lens.width, .height = lens.height, .samples = std::vector<std::uint8_t>(pixels, 90)};
}

TEST(BoardWatch, SaysThatNoBoardIsSeen) {
  BoardWatch watch(LaserSettings{}.lens);
  EXPECT_FALSE(watch.see(grey(LaserSettings{}.lens)));
  EXPECT_EQ(watch.look().advice, BoardAdvice::show);
  EXPECT_TRUE(watch.look().corners.empty());
}

TEST(BoardWatch, TakesABoardThatStandsStillOnce) {
  const BoardBeforeCamera board;
  BoardWatch watch(LaserSettings{}.lens);
  EXPECT_FALSE(watch.see(board.picture(0)));
  EXPECT_EQ(watch.look().advice, BoardAdvice::hold_still);
  EXPECT_FALSE(watch.see(board.picture(1)));
  EXPECT_TRUE(watch.see(board.picture(2)));
  EXPECT_FALSE(watch.see(board.picture(3)));  // the board has not moved
  EXPECT_EQ(watch.look().taken, 1);
  EXPECT_EQ(watch.look().advice, BoardAdvice::reach);
  ASSERT_GT(watch.look().corners.size(), 100U);
  for (const Eigen::Vector2d& corner : watch.look().corners) {
    EXPECT_TRUE((corner.array() > 0).all() && (corner.array() < 1).all());
  }
}

TEST(BoardWatch, TakesNoBoardThatMoves) {
  const BoardBeforeCamera board;
  BoardWatch watch(LaserSettings{}.lens);
  for (const int number : {4, 5, 6, 7, 12, 13}) {  // the board is moving, or has just come to rest
    EXPECT_FALSE(watch.see(board.picture(number))) << number;
    EXPECT_EQ(watch.look().advice, BoardAdvice::hold_still);
  }
}

TEST(BoardWatch, AsksForTiltWhereABoardIsHeldFlat) {
  const BoardBeforeCamera board;
  BoardWatch watch(LaserSettings{}.lens);
  // The same view of the board, shifted across the picture by whole pixels.
  const Picture whole = board.picture(0);
  for (int shift = 0; shift <= 60; shift += 15) {
    Picture moved = whole;
    const auto by = static_cast<std::ptrdiff_t>(shift * 8);
    std::rotate(moved.samples.begin(), moved.samples.begin() + by, moved.samples.end());
    for (int again = 0; again < 4; ++again) {
      watch.see(moved);
    }
  }
  EXPECT_GE(watch.look().taken, 4);
  EXPECT_EQ(watch.look().advice, BoardAdvice::tilt);
  EXPECT_FALSE(watch.is_complete());
}

TEST(BoardWatch, TakesEnoughOfAWavedBoardForItsLens) {
  const BoardBeforeCamera board;
  const LaserSimulation& truth = board.truth();
  BoardWatch watch(LaserSettings{}.lens);
  int pictures = 0;
  while (!watch.is_complete() && pictures < 250) {
    watch.see(board.picture(pictures++));
  }
  ASSERT_TRUE(watch.is_complete()) << watch.look().taken;
  EXPECT_GE(watch.look().taken, 12);
  const LensReport report = calibrate_lens(watch.views(), truth.lens.width, truth.lens.height);
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_NEAR(report.lens.intrinsics.fx, truth.lens.fx, 0.001 * truth.lens.fx);
  EXPECT_NEAR(report.lens.intrinsics.fy, truth.lens.fy, 0.001 * truth.lens.fy);
  EXPECT_NEAR(report.lens.intrinsics.cx, truth.lens.cx, 0.5);
  EXPECT_NEAR(report.lens.intrinsics.cy, truth.lens.cy, 0.5);
  EXPECT_NEAR(report.lens.k1, truth.k1, 0.003);
  EXPECT_NEAR(report.lens.k2, truth.k2, 0.012);
  EXPECT_LT(report.rms, 0.1);
}

TEST(BoardWatch, ForgetsAViewWhoseBoardMoved) {
  const BoardBeforeCamera board;
  BoardWatch watch(LaserSettings{}.lens);
  watch.see(board.picture(0));
  watch.see(board.picture(1));
  ASSERT_TRUE(watch.see(board.picture(2)));
  EXPECT_TRUE(watch.shows_last_view(board.picture(3)));
  EXPECT_FALSE(watch.shows_last_view(board.picture(8)));  // of the next pose
  watch.drop_last_view();
  EXPECT_EQ(watch.look().taken, 0);
  EXPECT_EQ(watch.look().coverage, LensCoverage{});
  EXPECT_EQ(watch.look().advice, BoardAdvice::hold_still);
  EXPECT_TRUE(watch.see(board.picture(4)));  // it is a new place again
}

}  // namespace
}  // namespace octurn
