#include "register/nearest_points.hpp"

#include <gtest/gtest.h>

#include "register/rigid_fit.hpp"
#include "support/random.hpp"

namespace octurn {
namespace {

Eigen::Vector3d random_point(Random& random, double side) {
  return {random.uniform() * side, random.uniform() * side, random.uniform() * side};
}

TEST(NearestPoints, IsNearlyTheNearestOfAll) {
  Random random(1);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back({.point = random_point(random, 0.06), .normal = Eigen::Vector3d::UnitZ()});
  }
  const NearestPoints nearest(points);
  // The nearest point is exact at a voxel's centre, and a query is at most half a voxel's diagonal
  // from that centre.
  constexpr double slack = 2 * 0.0026;
  int near = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d at = random_point(random, 0.06);
    double least = 1;
    for (const SurfacePoint& point : points) {
      least = std::min(least, (point.point - at).norm());
    }
    const SurfacePoint* const found = nearest.find(at);
    if (found != nullptr) {
      ++near;
      EXPECT_LE((found->point - at).norm(), least + slack);
    } else {
      EXPECT_GT(least, NearestPoints::cap - slack);
    }
  }
  EXPECT_GT(near, 100);
}

TEST(NearestPoints, KnowsNoneFarAway) {
  const NearestPoints nearest({{.point = {0, 0, 0}, .normal = {0, 0, 1}}});

  EXPECT_NE(nearest.find({0.005, 0, 0}), nullptr);
  EXPECT_EQ(nearest.find({0.02, 0, 0}), nullptr);
  EXPECT_EQ(nearest.find({1, 1, 1}), nullptr);
}

TEST(RigidFit, GivesTheMotionThatTakesPointsToTheirPlanes) {
  Random random(2);
  const Eigen::Vector3d middle(0.01, 0.02, 0.05);
  Eigen::Isometry3d wanted = Eigen::Isometry3d::Identity();
  wanted.linear() =
      Eigen::AngleAxisd(0.002, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  wanted.translation() = Eigen::Vector3d(0.0003, -0.0002, 0.0004);
  RigidFit fit{.middle = middle};
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d point = random_point(random, 0.1);
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    fit.add(point, normal, normal.dot(point - wanted * point), 1);
  }

  const Eigen::Isometry3d motion = fit.motion();

  // Damping keeps back a ten-thousandth of the motion; linearising the rotation errs by 0.002^2.
  EXPECT_LT((motion.matrix() - wanted.matrix()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(RigidFit, LeavesAloneWhatNothingOpposes) {
  RigidFit fit;
  for (const double x : {-0.05, 0.0, 0.05}) {
    for (const double y : {-0.05, 0.05}) {
      fit.add({x, y, 0}, Eigen::Vector3d::UnitZ(), -0.001, 1);  // a plane, 1 mm below another
    }
  }

  const Eigen::Isometry3d motion = fit.motion();

  EXPECT_NEAR(motion.translation().z(), 0.001, 1e-6);
  EXPECT_NEAR(motion.translation().head<2>().norm(), 0, 1e-9);
  EXPECT_TRUE(motion.linear().isIdentity(1e-9));
  const RigidFit::Matrix6d covariance = fit.covariance(1);
  EXPECT_GT(covariance(3, 3), 1000 * covariance(5, 5));  // it may slide, but not rise
}

}  // namespace
}  // namespace octurn
