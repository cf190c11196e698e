#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "core/register/laid_down.hpp"
#include "octurn/register.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr std::size_t stops = 8;

/// How far a pose is from the true one, at the object's middle.
void expect_near(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& truth, double max_mm,
                 double max_deg) {
  const Eigen::Vector3d middle(0, 0, 0.05);
  const Eigen::Isometry3d error = pose * truth.inverse();
  EXPECT_LT(mm_from_metres((error * middle - middle).norm()), max_mm);
  EXPECT_LT(degrees_from_radians(Eigen::AngleAxisd(error.linear()).angle()), max_deg);
}

// A Kinect's reading at 0.65 m is uncertain by 0.35 mm here; the figure has some 2,000 independent
// ones, most of them on curved surfaces.
TEST(RegisterTurns, FindsHowAFigureWasTurnedOver) {
  const Eigen::Isometry3d truth = turned_over(figure_height);

  const Registration found =
      register_turns(std::array{laid_turn(figure(), stops), laid_turn(figure(), stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  ASSERT_EQ(found.poses.size(), 2U);
  EXPECT_TRUE(found.poses[0].object_from_platform.matrix().isIdentity());
  expect_near(found.poses[1].object_from_platform, truth, 0.15, 0.15);
  EXPECT_FALSE(found.poses[1].symmetric);
  EXPECT_GT(found.poses[1].overlap, 0.35);
  EXPECT_LT(found.poses[1].position_sigma, 0.0003);
}

TEST(RegisterTurns, IsTheSameForAnyNumberOfThreads) {
  const std::array turns{laid_turn(figure(), stops),
                         laid_turn(figure(), stops, turned_over(figure_height))};

  const Registration one = register_turns(turns, 1);
  const Registration three = register_turns(turns, 3);

  ASSERT_TRUE(one.accepted && three.accepted);
  EXPECT_EQ(one.poses[1].object_from_platform.matrix(),
            three.poses[1].object_from_platform.matrix());
  EXPECT_EQ(one.poses[1].position_sigma, three.poses[1].position_sigma);
}

TEST(RegisterTurns, TakesAKnownPoseAsItIs) {
  const Eigen::Isometry3d truth = turned_over(figure_height);
  std::array turns{laid_turn(figure(), stops), laid_turn(figure(), stops, truth),
                   laid_turn(figure(), stops, turned_over(figure_height, 190))};
  turns[1].object_from_platform = truth;

  const Registration found = register_turns(turns);

  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_EQ(found.poses[1].object_from_platform.matrix(), truth.matrix());
  expect_near(found.poses[2].object_from_platform, turned_over(figure_height, 190), 0.15, 0.15);
}

TEST(RegisterTurns, RefusesTwoObjects) {
  const Shape other = joined(block({0.1, 0.03, 0.05}), ball({0.03, 0, 0.06}, 0.03));

  const Registration found =
      register_turns(std::array{laid_turn(figure(), stops), laid_turn(other, stops)});

  EXPECT_FALSE(found.accepted);
  EXPECT_TRUE(found.poses.empty());
  EXPECT_NE(found.reason.find("two objects"), std::string::npos) << found.reason;
}

TEST(RegisterTurns, RefusesAnEmptyPlatform) {
  const Shape nothing = ball({0, 0, -1}, 0.01);

  const Registration found =
      register_turns(std::array{laid_turn(figure(), stops), laid_turn(nothing, stops)});

  EXPECT_FALSE(found.accepted);
  EXPECT_NE(found.reason.find("turn 1"), std::string::npos) << found.reason;
}

/// A prism that has a face for each side, but none that is slanted: turned over, it shares no face
/// that tells how high it stood. Its plan is no mirror image of itself.
Shape prism() {
  const Eigen::Vector3d aside(0.025, 0.02, 0);
  return joined(block({0.1, 0.03, 0.05}), moved(block({0.03, 0.08, 0.05}), aside));
}

// A platform's plane is known to 0.02 mm, and the mean of a face of some 40 cm2 to better than 0.1.
TEST(RegisterTurns, SetsAFlatFootOnItsPlatform) {
  const Eigen::Isometry3d truth = turned_over(0.05);

  const Registration found =
      register_turns(std::array{laid_turn(prism(), stops), laid_turn(prism(), stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  expect_near(found.poses[1].object_from_platform, truth, 0.3, 0.3);
}

// Each of four poses is right: the true one takes the block to where the found one has it.
TEST(RegisterTurns, TellsThatABlockIsSymmetric) {
  const Eigen::Vector3d size(0.09, 0.06, 0.05);
  const Eigen::Isometry3d truth = turned_over(size.z());

  const Registration found = register_turns(
      std::array{laid_turn(block(size), stops), laid_turn(block(size), stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_TRUE(found.poses[1].symmetric);
  const Eigen::Isometry3d error = found.poses[1].object_from_platform * truth.inverse();
  for (const double z : {0.0, size.z()}) {
    const Eigen::Vector3d corner(size.x() / 2, size.y() / 2, z);
    const Eigen::Vector3d moved_to = error * corner;
    EXPECT_NEAR(std::abs(moved_to.x()), corner.x(), 0.0005);
    EXPECT_NEAR(std::abs(moved_to.y()), corner.y(), 0.0005);
    EXPECT_NEAR(std::abs(moved_to.z() - size.z() / 2), size.z() / 2, 0.0005);
  }
}

// Any rotation is right; the middle must stay.
TEST(RegisterTurns, TellsThatABallIsSymmetric) {
  const Shape round = ball({0, 0, 0.04}, 0.04);
  const Eigen::Isometry3d truth = turned_over(0.08);

  const Registration found =
      register_turns(std::array{laid_turn(round, stops), laid_turn(round, stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_TRUE(found.poses[1].symmetric);
  const Eigen::Vector3d middle(0, 0, 0.04);
  const Eigen::Vector3d found_middle =
      found.poses[1].object_from_platform * (truth.inverse() * middle);
  EXPECT_NEAR((found_middle - middle).norm(), 0, 0.0003);
}

// The first turn shows a square block; only the second one shows the dent in its underside, which
// may then be at any of four corners.
TEST(RegisterTurns, RefusesToGuessWhereADentIs) {
  const Shape dented = [whole = block({0.08, 0.08, 0.05}), dent = ball({0.018, 0.018, 0}, 0.015)](
                           const Eigen::Vector3d& p) { return std::max(whole(p), -dent(p)); };

  const Registration found = register_turns(
      std::array{laid_turn(dented, stops), laid_turn(dented, stops, turned_over(0.05))});

  EXPECT_FALSE(found.accepted);
  EXPECT_NE(found.reason.find("different shapes"), std::string::npos) << found.reason;
}

TEST(RegisterTurns, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const RegistrationTurn turn = laid_turn(figure(), 2);

  EXPECT_THROW(register_turns(std::array{turn, turn}, 1, source.get_token()), Stopped);
}

}  // namespace
}  // namespace octurn
