#include "register/compare_rivals.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/register/laid_down.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// The turn with a configured sensor pose that is off by some 10 mm and 1.6 degrees.
RegistrationTurn misaligned(RegistrationTurn turn) {
  turn.platform_from_sensor =
      Eigen::Translation3d(0.006, -0.006, 0.0052) *
      Eigen::AngleAxisd(radians_from_degrees(1.6), Vector3d(1, 1, 0.3).normalized()) *
      turn.platform_from_sensor;
  return turn;
}

/// Compares two candidate poses for the turn of a figure that was turned over: the right one, and a
/// rival rotated away from it about the points' centroid.
Rivals rivals(const RegistrationTurn& upright, const RegistrationTurn& over, double rival_deg,
              const Vector3d& axis) {
  const SeenTurn placed = read_turn(upright, 2, {});
  const SeenTurn turn = read_turn(over, 2, {});
  const Target target =
      make_target({{.turn = &placed, .object_from_turn = Isometry3d::Identity()}});
  const NearestPoints points(turn.points);
  PoseCandidate best = refine_candidate(target, turn, turned_over(figure_height));
  PoseCandidate rival = best;
  const Vector3d middle = best.target_from_points * points.middle();
  rival.target_from_points = Eigen::Translation3d(middle) *
                             Eigen::AngleAxisd(radians_from_degrees(rival_deg), axis) *
                             Eigen::Translation3d(-middle) * best.target_from_points;
  return compare_rivals(target, turn, points, {best, rival}, 2, {});
}

RegistrationTurn upright(std::size_t stops) { return laid_turn(figure(), stops); }

RegistrationTurn over(std::size_t stops) {
  return laid_turn(figure(), stops, turned_over(figure_height));
}

// With few readings the fit of points ends in a neighbouring pose that seems to fit as well. The
// fit of readings takes both to one pose.
TEST(CompareRivals, AreOneWhereTheReadingsJoinThem) {
  EXPECT_EQ(rivals(upright(6), over(6), 5, Vector3d(1, 1, 1).normalized()).reason, "");
}

// With a wrong sensor pose, the fits of two neighbours end 2 degrees and 1.6 mm apart, each
// uncertain by 1.1 degrees and 1.4 mm. They count as one pose, and not as a symmetry.
TEST(CompareRivals, AreOneWhereTheyDifferByNoMoreThanTheirUncertainty) {
  const Rivals told = rivals(misaligned(upright(3)), misaligned(over(3)), 7, Vector3d::UnitY());

  EXPECT_EQ(told.reason, "");
  EXPECT_FALSE(told.symmetric);
}

TEST(CompareRivals, AreToldWhereTheyGiveAnotherShape) {
  EXPECT_EQ(rivals(upright(6), over(6), 60, Vector3d(1, 1, 1).normalized()).reason,
            "two poses that are 60 degrees apart fit alike, and give different shapes");
}

}  // namespace
}  // namespace octurn
