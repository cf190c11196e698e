#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/register/laid_down.hpp"
#include "octurn/register.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr std::size_t stops = 8;

/// Expects a pose to be within these bounds of the true one at the object's centre.
void expect_near(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& truth, double max_mm,
                 double max_deg) {
  const Eigen::Vector3d middle(0, 0, 0.05);
  const Eigen::Isometry3d error = pose * truth.inverse();
  EXPECT_LT(mm_from_metres((error * middle - middle).norm()), max_mm);
  EXPECT_LT(degrees_from_radians(Eigen::AngleAxisd(error.linear()).angle()), max_deg);
}

// A Kinect's reading at 0.65 m has a sigma of 0.35 mm here; the figure has some 2,000 independent
// readings, most of them on curved surfaces.
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

/// A lump some 12 cm long, smooth everywhere: a smooth union of balls.
Shape lump() {
  return [](const Eigen::Vector3d& p) {
    constexpr double blend = 0.012;  // metres
    double sum = 0;
    for (const Shape& part : {ball({0.02, 0.005, 0.05}, 0.04), ball({-0.035, -0.01, 0.045}, 0.03),
                              ball({0, 0.03, 0.06}, 0.028), ball({0.01, -0.025, 0.035}, 0.025)}) {
      sum += std::exp(-part(p) / blend);
    }
    return -blend * std::log(sum);
  };
}

// The first turn could not see most of the surface that the second one sees. Readings there are no
// misfit.
TEST(RegisterTurns, FindsASmoothLumpThatSharesLittle) {
  const Eigen::Translation3d middle(0, 0, 0.055);
  const Eigen::Isometry3d truth =
      middle *
      Eigen::AngleAxisd(radians_from_degrees(160), Eigen::Vector3d(1, 0.4, 0.2).normalized()) *
      middle.inverse();

  const Registration found =
      register_turns(std::array{laid_turn(lump(), 6), laid_turn(lump(), 6, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  expect_near(found.poses[1].object_from_platform, truth, 0.5, 1);
  EXPECT_LT(found.poses[1].overlap, 0.5);
}

/// A pebble of some 12 x 9 x 7 cm. Half a turn about any of its axes moves its surface by 1 to 3
/// mm, less than the margin before a surface at which free space begins.
Shape pebble() {
  return [](const Eigen::Vector3d& p) {
    const Eigen::Array3d radii(0.060, 0.045, 0.033);  // metres
    const Eigen::Vector3d at = ((p - Eigen::Vector3d(0, 0, 0.036)).array() / radii).matrix();
    const Eigen::Vector3d way = at.normalized();
    const double odd = std::pow(way.x(), 3) + 1.5 * way.y() * way.y() * way.z();
    return (at.norm() - 1 - 0.035 * odd) * radii.minCoeff();
  };
}

// Free space contradicts a pose half a turn off as little as the true one. Only its fit is worse,
// where both turns saw the surface.
TEST(RegisterTurns, FindsHowANearlySymmetricPebbleWasTurned) {
  const Eigen::Translation3d middle(0, 0, 0.036);
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0.3, 0.1), Eigen::Vector3d(0.2, 1, 0.4), Eigen::Vector3d(0.1, 0.2, 1)}) {
    const Eigen::Isometry3d truth =
        middle * Eigen::AngleAxisd(radians_from_degrees(150), axis.normalized()) * middle.inverse();

    const Registration found =
        register_turns(std::array{laid_turn(pebble(), 6), laid_turn(pebble(), 6, truth)});

    ASSERT_TRUE(found.accepted) << found.reason;
    expect_near(found.poses[1].object_from_platform, truth, 0.5, 1);
  }
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

/// A prism without slanted faces: turned over, no face that both turns see fixes its height. Its
/// plan has no mirror symmetry.
Shape prism() {
  const Eigen::Vector3d aside(0.025, 0.02, 0);
  return joined(block({0.1, 0.03, 0.05}), moved(block({0.03, 0.08, 0.05}), aside));
}

// The platform's plane is known to 0.02 mm, the mean of a face of some 40 cm2 to better than 0.1
// mm.
TEST(RegisterTurns, SetsAFlatFootOnItsPlatform) {
  const Eigen::Isometry3d truth = turned_over(0.05);

  const Registration found =
      register_turns(std::array{laid_turn(prism(), stops), laid_turn(prism(), stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  expect_near(found.poses[1].object_from_platform, truth, 0.3, 0.3);
}

// Four poses are equally right; each maps the block onto itself.
TEST(RegisterTurns, TellsThatABlockIsSymmetric) {
  const Eigen::Vector3d size(0.09, 0.06, 0.05);
  const Eigen::Isometry3d truth = turned_over(size.z());

  const Registration found = register_turns(
      std::array{laid_turn(block(size), stops), laid_turn(block(size), stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_TRUE(found.poses[1].symmetric);
  ASSERT_GT(found.candidates.size(), 1U);  // the equivalent three are no candidates
  EXPECT_GT(found.candidates[1].contradiction, found.candidates[0].contradiction + 0.1);
  const Eigen::Isometry3d error = found.poses[1].object_from_platform * truth.inverse();
  for (const double z : {0.0, size.z()}) {
    const Eigen::Vector3d corner(size.x() / 2, size.y() / 2, z);
    const Eigen::Vector3d moved_to = error * corner;
    EXPECT_NEAR(std::abs(moved_to.x()), corner.x(), 0.0005);
    EXPECT_NEAR(std::abs(moved_to.y()), corner.y(), 0.0005);
    EXPECT_NEAR(std::abs(moved_to.z() - size.z() / 2), size.z() / 2, 0.0005);
  }
}

// Any rotation is right as long as the centre stays in place.
TEST(RegisterTurns, TellsThatABallIsSymmetric) {
  const Shape round = ball({0, 0, 0.04}, 0.04);
  const Eigen::Isometry3d truth = turned_over(0.08);

  const Registration found =
      register_turns(std::array{laid_turn(round, stops), laid_turn(round, stops, truth)});

  ASSERT_TRUE(found.accepted) << found.reason;
  EXPECT_TRUE(found.poses[1].symmetric);
  // The rotation chosen shows the underside, for which the ball was turned over.
  EXPECT_LT(found.poses[1].object_from_platform(2, 2), 0.3);
  const Eigen::Vector3d middle(0, 0, 0.04);
  const Eigen::Vector3d found_middle =
      found.poses[1].object_from_platform * (truth.inverse() * middle);
  EXPECT_NEAR((found_middle - middle).norm(), 0, 0.0003);
}

// The angle about the cylinder's axis and its direction are undetermined; the axis's position is
// not. The sensor sees the top of a low cylinder at a slant; without those readings the sides would
// slide along each other.
TEST(RegisterTurns, TellsThatACylinderIsSymmetric) {
  for (const double height : {0.05, 0.07, 0.1}) {
    const Shape round = cylinder(0.03, height);
    const Eigen::Isometry3d truth = turned_over(height);

    const Registration found =
        register_turns(std::array{laid_turn(round, stops), laid_turn(round, stops, truth)});

    ASSERT_TRUE(found.accepted) << found.reason;
    EXPECT_TRUE(found.poses[1].symmetric);
    const Eigen::Isometry3d error = found.poses[1].object_from_platform * truth.inverse();
    const Eigen::Vector3d one = error * Eigen::Vector3d(0, 0, 0);
    const Eigen::Vector3d other = error * Eigen::Vector3d(0, 0, height);
    EXPECT_LT(one.head<2>().norm(), 0.0002);
    EXPECT_LT(other.head<2>().norm(), 0.0002);
    EXPECT_NEAR(std::min(one.z(), other.z()), 0, 0.0002);
    EXPECT_NEAR(std::max(one.z(), other.z()), height, 0.0002);
  }
}

// The first turn shows a square block. Only the second turn shows the dent in its underside, so the
// dent may be at any of four corners.
TEST(RegisterTurns, RefusesToGuessWhereADentIs) {
  const Shape dented = [whole = block({0.08, 0.08, 0.05}), dent = ball({0.018, 0.018, 0}, 0.015)](
                           const Eigen::Vector3d& p) { return std::max(whole(p), -dent(p)); };

  std::array turns{laid_turn(dented, stops), laid_turn(dented, stops, turned_over(0.05))};

  const Registration found = register_turns(turns);

  EXPECT_FALSE(found.accepted);
  EXPECT_NE(found.reason.find("different shapes"), std::string::npos) << found.reason;
  ASSERT_GE(found.candidates.size(), 4U);  // one for each corner
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(found.candidates[i].contradiction, 0.1);
  }
  // A person who knows the object chooses one; the other candidates must not refuse it.
  turns[1].prior_object_from_platform = found.candidates[2].object_from_platform;
  const Registration told = register_turns(turns);
  ASSERT_TRUE(told.accepted) << told.reason;
  expect_near(told.poses[1].object_from_platform, found.candidates[2].object_from_platform, 1, 1);
  EXPECT_TRUE(told.candidates.empty());
}

// The told pose is off by ten degrees, and by 7 mm at the centre, as one from three clicked point
// pairs may be.
TEST(RegisterTurns, RefinesAPoseThatIsToldRoughly) {
  const Eigen::Isometry3d truth = turned_over(figure_height);
  std::array turns{laid_turn(figure(), stops), laid_turn(figure(), stops, truth)};
  const Eigen::Translation3d middle(0, 0, figure_height / 2);
  turns[1].prior_object_from_platform =
      truth * Eigen::Translation3d(0.004, -0.003, 0.005) * middle *
      Eigen::AngleAxisd(radians_from_degrees(10), Eigen::Vector3d(1, 2, 2) / 3) * middle.inverse();

  const Registration found = register_turns(turns);

  ASSERT_TRUE(found.accepted) << found.reason;
  expect_near(found.poses[1].object_from_platform, truth, 0.15, 0.15);
}

TEST(RegisterTurns, RefusesAToldPoseThatContradictsWhatWasSeen) {
  const Eigen::Isometry3d truth = turned_over(figure_height);
  std::array turns{laid_turn(figure(), stops), laid_turn(figure(), stops, truth)};
  turns[1].prior_object_from_platform =
      truth * Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());

  const Registration found = register_turns(turns);

  EXPECT_FALSE(found.accepted);
  EXPECT_NE(found.reason, "");
}

TEST(RegisterTurns, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  const RegistrationTurn turn = laid_turn(figure(), 2);

  EXPECT_THROW(register_turns(std::array{turn, turn}, 1, source.get_token()), Stopped);
}

}  // namespace
}  // namespace octurn
