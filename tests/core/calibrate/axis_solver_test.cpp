#include "calibrate/axis_solver.hpp"

#include <gtest/gtest.h>

#include "core/calibrate/views_of.hpp"

namespace octurn {
namespace {

constexpr double tight = radians_from_degrees(0.02);

TEST(AxisSolver, FindsTheAxisOfAnObjectFromAPoseThatIsWrong) {
  const TurnViews views = views_of(rendered_turn(figure(), 12));
  const Eigen::Isometry3d start =
      level(wrong_pose({0.012, -0.015, 0}, {1, 0.3, 0}, 2), true_plane());

  const auto solution = solve_axis(views, true_plane(), start, tight, 1);

  ASSERT_TRUE(solution);
  const AxisError error = axis_error(solution->platform_from_sensor);
  // Required accuracy of a Kinect with eight stops; the readings have 0.35 mm of noise.
  EXPECT_LT(error.position_mm, 0.12);
  EXPECT_LT(error.direction_deg, 0.05);
  EXPECT_LT(error.height_mm, 0.06);
  EXPECT_LT(solution->last_step, 1e-5);
  // Three of the solver's own sigmas in each of two coordinates: 3 * sqrt(2) = 4.2, at most 4.
  EXPECT_LT(error.position_mm, mm_from_metres(4 * solution->position_sigma()));
  EXPECT_LT(error.direction_deg, degrees_from_radians(4 * solution->direction_sigma()));
}

TEST(AxisSolver, TakesTheDirectionThatABallLeavesOpenFromThePlane) {
  const TurnViews views = views_of(rendered_turn(ball({0, 0, 0.06}, 0.055), 12));
  const auto solved = [&](double sigma_deg) {
    return solve_axis(views, true_plane(), true_platform_from_sensor(),
                      radians_from_degrees(sigma_deg), 1);
  };
  const auto near = solved(0.02);
  const auto wide = solved(2);
  ASSERT_TRUE(near && wide);
  EXPECT_LT(degrees_from_radians(near->direction_sigma()), 0.021);
  EXPECT_GT(wide->direction_sigma(), 5 * near->direction_sigma());
  EXPECT_LT(axis_error(near->platform_from_sensor).position_mm, 0.3);
}

TEST(AxisSolver, SolvesNothingWhereNothingIsSeenTwice) {
  TurnViews views = views_of(rendered_turn(figure(), 8));
  views.pairs.clear();
  EXPECT_FALSE(solve_axis(views, true_plane(), true_platform_from_sensor(), tight, 1));
}

}  // namespace
}  // namespace octurn
