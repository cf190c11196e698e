#include <gtest/gtest.h>

#include <vector>

#include "core/register/laid_down.hpp"
#include "octurn/register.hpp"

namespace octurn {
namespace {

TEST(PoseFromPairs, IsThePoseThatThreePairsHaveInCommon) {
  const Eigen::Isometry3d truth = turned_over(0.1, 70);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.03, 0.01, 0.02), Eigen::Vector3d(-0.04, 0.02, 0.05),
        Eigen::Vector3d(0.01, -0.03, 0.08)}) {
    pairs.push_back({.object = truth * point, .platform = point});
  }

  const auto pose = pose_from_pairs(pairs);

  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->isApprox(truth, 1e-12));
}

TEST(PoseFromPairs, IsUnknownOfPointsOnALine) {
  std::vector<PointPair> pairs;
  for (const double at : {0.0, 0.02, 0.06}) {
    pairs.push_back({.object = {at, at, 0}, .platform = {0, at, at}});
  }

  EXPECT_FALSE(pose_from_pairs(pairs));
  EXPECT_FALSE(pose_from_pairs({}));
}

}  // namespace
}  // namespace octurn
