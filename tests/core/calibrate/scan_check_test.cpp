#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/quality.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

const Box roomy{.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}};

/// The figures of a turn's stops for which `is_taken(stop)` holds, with the turn's pose.
template <typename IsTaken>
ScanFigures figures(const CalibrationTurn& turn, const Box& clip, IsTaken is_taken) {
  ScanCheck check(clip, turn.angles.size());
  for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
    if (is_taken(stop)) {
      check.add(stop, {.frame = turn.read(stop),
                       .intrinsics = turn.intrinsics,
                       .object_from_sensor =
                           object_from_sensor(turn.platform_from_sensor, turn.angles[stop])});
    }
  }
  return check.figures();
}

ScanFigures figures(const CalibrationTurn& turn, const Box& clip = roomy) {
  return figures(turn, clip, [](std::size_t) { return true; });
}

TEST(ScanCheck, FindsNothingWrongWithARightRig) {
  const ScanFigures scan = figures(rendered_turn(figure(), 8));
  EXPECT_EQ(scan.stops, 8U);
  EXPECT_NEAR(scan.distance, 0.66, 0.05);
  EXPECT_NEAR(degrees_from_radians(scan.widest_gap), 45, 0.01);
  EXPECT_NEAR(scan.platform_height.value_or(1), 0, 0.0005);
  // The noise is 0.3 steps of 1.3 mm at 0.66 m; edges that two stops see differently add to it.
  EXPECT_LT(scan.disagreement, 0.0007);
  EXPECT_LT(std::ranges::max(scan.contradicted), 0.05);
  EXPECT_EQ(std::ranges::max(scan.cut_pixels), 0);
}

TEST(ScanCheck, SeesThatStopsDisagreeWithARigTwoDegreesOff) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  const double right = figures(turn).disagreement;
  turn.platform_from_sensor = wrong_pose({0, 0, 0}, {0, 1, 0}, 2);
  // The tilt moves the top, 12 cm up, by 4 mm: neighbouring stops, 45 degrees apart, see it 3 mm
  // apart.
  EXPECT_GT(figures(turn).disagreement, 2 * right);
  EXPECT_GT(figures(turn).disagreement, 0.0011);
  EXPECT_FALSE(figures(turn).differing.disagreeing.empty());
}

TEST(ScanCheck, MeasuresHowFarThePlatformIsFromWhereItShouldBe) {
  CalibrationTurn turn = rendered_turn(figure(), 4);
  turn.platform_from_sensor = wrong_pose({0, 0, 0.012}, {1, 0, 0}, 0);
  EXPECT_NEAR(figures(turn).platform_height.value_or(0), 0.012, 0.0005);
  turn.platform_from_sensor = wrong_pose({0, 0, -0.007}, {1, 0, 0}, 0);
  EXPECT_NEAR(figures(turn).platform_height.value_or(0), -0.007, 0.0005);
}

TEST(ScanCheck, SeesABoxThatIsTooLowCutTheHeadOff) {
  const CalibrationTurn turn = rendered_turn(figure(), 4);
  const Box low{.min = roomy.min, .max = {0.14, 0.14, 0.09}};
  const ScanFigures scan = figures(turn, low);
  const auto cut = scan.cut_pixels;
  // The box cuts the ball of 7 cm 5 mm above its centre: a line of 60 pixels of 1.1 mm.
  EXPECT_GT(cut[4], 20);
  EXPECT_LT(cut[4], 120);
  EXPECT_EQ(cut[0] + cut[1] + cut[2] + cut[3], 0);
  ASSERT_FALSE(scan.cut_places[4].empty());
  for (const Eigen::Vector3d& place : scan.cut_places[4]) {
    EXPECT_NEAR(place.z(), 0.09, 0.008);  // a cell and a pixel
    EXPECT_NEAR((place - Eigen::Vector3d(0.02, 0.01, 0.085)).norm(), 0.035, 0.008);  // the ball
  }
}

TEST(ScanCheck, NamesTheSideThatCuts) {
  const CalibrationTurn turn = rendered_turn(figure(), 4);
  const Box narrow{.min = roomy.min, .max = {0.02, 0.14, 0.4}};
  const auto cut = figures(turn, narrow).cut_pixels;
  EXPECT_EQ(std::ranges::max_element(cut) - cut.begin(), 1);
  EXPECT_GT(cut[1], 20);
}

TEST(ScanCheck, MeasuresTheGapThatMissingStopsLeave) {
  const CalibrationTurn turn = rendered_turn(figure(), 8);
  const ScanFigures half = figures(turn, roomy, [](std::size_t stop) { return stop < 4; });
  EXPECT_EQ(half.stops, 4U);
  EXPECT_NEAR(degrees_from_radians(half.widest_gap), 225, 0.01);
}

/// A turn of eight stops with a hand in the frame at stop 3.
CalibrationTurn turn_with_hand() {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  const Shape with_hand = joined(figure(), moved(ball({0, 0, 0.05}, 0.03), {-0.075, 0.075, 0}));
  std::mt19937 random(5);
  const DepthFrame hand = rendered_frame(with_hand, turn.angles[3], random);
  turn.read = [hand, others = turn.read](std::size_t stop) {
    return stop == 3 ? hand : others(stop);
  };
  return turn;
}

TEST(ScanCheck, FindsTheStopAtWhichAHandWasInThePicture) {
  const ScanFigures scan = figures(turn_with_hand());
  const auto& contradicted = scan.contradicted;
  EXPECT_EQ(std::ranges::max_element(contradicted) - contradicted.begin(), 3);
  EXPECT_GT(contradicted[3], 0.1);
  ASSERT_FALSE(scan.differing.contradicted.empty());
  for (const Eigen::Vector3d& place : scan.differing.contradicted) {
    // The ball's radius, half a cell's diagonal, and the noise.
    EXPECT_LT((place - Eigen::Vector3d(-0.075, 0.075, 0.05)).norm(), 0.03 + 0.0035 + 0.002);
  }
}

/// A turn of a block before the disc, whose readings above `height` metres are lost.
CalibrationTurn turn_with_dark_top(double height) {
  CalibrationTurn turn = rendered_turn(block({0.06, 0.04, 0.05}), 6);
  turn.read = [height, turn](std::size_t stop) {
    DepthFrame frame = turn.read(stop);
    for (int v = 0; v < frame.height; ++v) {
      for (int u = 0; u < frame.width; ++u) {
        std::uint16_t& depth = frame.depth[static_cast<std::size_t>(v * frame.width + u)];
        const double z = depth * turn.intrinsics.depth_unit;
        const Eigen::Vector3d ray((u - turn.intrinsics.cx) / turn.intrinsics.fx,
                                  (v - turn.intrinsics.cy) / turn.intrinsics.fy, 1);
        depth = (turn.platform_from_sensor * (z * ray)).z() > height ? std::uint16_t{0} : depth;
      }
    }
    return frame;
  };
  return turn;
}

TEST(ScanCheck, MeasuresTheHoleInTheReadingsAboveADarkTop) {
  EXPECT_LT(figures(turn_with_dark_top(1)).unseen_top, 0.005);
  // As the sensor sees it, 25 mm of the sides and a lid of 40 to 60 mm, foreshortened.
  const double hole = figures(turn_with_dark_top(0.025)).unseen_top;
  EXPECT_GT(hole, 0.025);
  EXPECT_LT(hole, 0.06);
}

TEST(ScanCheck, CountsWhatLiesBetweenThePlatformsNoiseAndTheBox) {
  const Box high{.min = {-0.14, -0.14, 0.005}, .max = roomy.max};
  const ScanFigures tile = figures(rendered_turn(block({0.08, 0.08, 0.004}), 6), high);
  EXPECT_GT(tile.below.pixels, 1000);  // of about 2,300 that see the tile
  EXPECT_LT(tile.below.noise_end, 0.004);
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  EXPECT_LT(figures(rendered_turn(nothing, 6), high).below.pixels, 60);
}

TEST(ScanCheck, LowersTheBoxOnlyForWhatIsMostlyBelowIt) {
  const Box high{.min = {-0.14, -0.14, 0.005}, .max = roomy.max};
  const auto bottom = [&](const Shape& object) {
    const CalibrationTurn turn = rendered_turn(object, 6);
    ScanCheck check(high, turn.angles.size());
    for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
      check.add(stop, {.frame = turn.read(stop),
                       .intrinsics = turn.intrinsics,
                       .object_from_sensor =
                           object_from_sensor(turn.platform_from_sensor, turn.angles[stop])});
    }
    return check.lower_bottom();
  };
  const auto below_tile = bottom(block({0.08, 0.08, 0.004}));
  ASSERT_TRUE(below_tile);
  EXPECT_GT(*below_tile, 0.001);
  EXPECT_LT(*below_tile, 0.004);
  EXPECT_TRUE(bottom(block({0.03, 0.03, 0.003}))) << "as small as a coin";
  EXPECT_FALSE(bottom(joined(block({0.08, 0.08, 0.004}), block({0.06, 0.06, 0.06}))));
  EXPECT_FALSE(bottom([](const Eigen::Vector3d&) { return 1.0; })) << "an empty platform";
}

/// The middles of leaves on a ball that rests 1 cm above the platform, in the sensor's view.
std::vector<Eigen::Vector3d> leaves_around(double radius, double excess) {
  std::vector<Eigen::Vector3d> leaves;
  for (int i = 0; i < 400; ++i) {
    const double z = 1 - (i + 0.5) / 400;  // the upper half
    const double angle = 2.4 * i;
    const Eigen::Vector3d out(std::sqrt(1 - z * z) * std::cos(angle),
                              std::sqrt(1 - z * z) * std::sin(angle), z);
    leaves.emplace_back(Eigen::Vector3d(0, 0, 0.06) + (radius + excess) * out);
  }
  return leaves;
}

TEST(ScanCheck, MeasuresHowFarAShellIsOutsideOfWhatTheStopsSaw) {
  const CalibrationTurn turn = rendered_turn(ball({0, 0, 0.06}, 0.05), 12);
  ScanCheck check(roomy, turn.angles.size());
  for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
    check.add(stop, {.frame = turn.read(stop),
                     .intrinsics = turn.intrinsics,
                     .object_from_sensor =
                         object_from_sensor(turn.platform_from_sensor, turn.angles[stop])});
  }
  // The stops' noise, 0.4 mm in each, is in the outermost twentieth of the leaves.
  EXPECT_NEAR(check.figures(1, leaves_around(0.05, 0)).shell.swelling, 0.0003, 0.0003);
  EXPECT_NEAR(check.figures(1, leaves_around(0.05, 0.003)).shell.swelling, 0.0033, 0.0003);
  EXPECT_EQ(check.figures(1, leaves_around(0.05, 0.003)).shell.stray_share, 0);
  std::vector<Eigen::Vector3d> stray = leaves_around(0.05, 0);
  for (int i = 0; i < 20; ++i) {  // an arc in the air
    stray[static_cast<std::size_t>(20 * i)] = {0.1 * std::cos(0.3 * i), 0.1 * std::sin(0.3 * i),
                                               0.1};
  }
  EXPECT_NEAR(check.figures(1, stray).shell.stray_share, 0.05, 0.005);
}

TEST(ScanCheck, KeepsWhereSeveralStopsSawTheObject) {
  const std::vector<Eigen::Vector3d> seen = figures(turn_with_hand()).seen;
  for (const Eigen::Vector3d& place : seen) {
    // Half a cell's diagonal, and the noise.
    EXPECT_LT(std::abs(figure()(place)), 0.0044 + 0.0015) << place.transpose();
  }
  const auto is_seen = [&](const Eigen::Vector3d& point) {
    return std::ranges::any_of(
        seen, [&](const Eigen::Vector3d& place) { return (place - point).norm() < 0.006; });
  };
  EXPECT_TRUE(is_seen({0.02, 0.01, 0.12}));     // the top
  EXPECT_TRUE(is_seen({0.035, 0.0225, 0.03}));  // an upright edge, 3 cm up
  EXPECT_TRUE(is_seen({-0.035, 0, 0.03}));      // a side
}

TEST(ScanCheck, CountsNextToNothingOnAnEmptyPlatform) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  EXPECT_LT(figures(rendered_turn(nothing, 4)).object_pixels, 120);
}

}  // namespace
}  // namespace octurn
