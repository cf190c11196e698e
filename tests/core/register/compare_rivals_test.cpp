#include "register/compare_rivals.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/register/laid_down.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A figure that was turned over, and what two candidates for how it lay say of one another.
class CompareRivals : public ::testing::Test {
 protected:
  /// @param rival_deg  how far the second candidate is turned away from the right one
  Rivals rivals(double rival_deg) const {
    const Target target =
        make_target({{.turn = &upright_, .object_from_turn = Isometry3d::Identity()}});
    const NearestPoints points(over_.points);
    PoseCandidate best = refine_candidate(target, over_, truth_);
    PoseCandidate rival = best;
    const Vector3d middle = best.target_from_points * points.middle();
    rival.target_from_points =
        Eigen::Translation3d(middle) *
        Eigen::AngleAxisd(radians_from_degrees(rival_deg), Vector3d(1, 1, 1).normalized()) *
        Eigen::Translation3d(-middle) * best.target_from_points;
    return compare_rivals(target, over_, points, {best, rival}, 2, {});
  }

  Isometry3d truth_ = turned_over(figure_height);
  SeenTurn upright_ = read_turn(laid_turn(figure(), 6), 2, {});
  SeenTurn over_ = read_turn(laid_turn(figure(), 6, truth_), 2, {});
};

// A neighbour that seems to fit as well is where few readings left the points' fit.
TEST_F(CompareRivals, AreOneWhereTheReadingsJoinThem) { EXPECT_EQ(rivals(5).reason, ""); }

TEST_F(CompareRivals, AreToldWhereTheyGiveAnotherShape) {
  EXPECT_EQ(rivals(60).reason,
            "two poses that are 60 degrees apart fit alike, and give different shapes");
}

}  // namespace
}  // namespace octurn
