#include <gtest/gtest.h>

#include <array>

#include "build/merged_scan.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

SolvedPose solved(double x_mm, double tilt_deg, double sigma_mm = 0.1) {
  SolvedPose turn{.position_sigma = metres_from_mm(sigma_mm),
                  .direction_sigma = radians_from_degrees(0.02)};
  turn.platform_from_sensor =
      Eigen::Translation3d(metres_from_mm(x_mm), -0.62, 0.36) *
      Eigen::AngleAxisd(radians_from_degrees(tilt_deg), Eigen::Vector3d::UnitX());
  return turn;
}

TEST(SharedPose, IsTheMeanOfTurnsThatAgree) {
  const auto pose = shared_pose(std::array{solved(0, 25), solved(0.2, 25)});

  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->isApprox(solved(0.1, 25).platform_from_sensor, 1e-9));
}

TEST(SharedPose, GoesByTheSmallerSigma) {
  const auto pose = shared_pose(std::array{solved(0, 25, 0.1), solved(0.25, 25, 0.2)});

  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->isApprox(solved(0.05, 25).platform_from_sensor, 1e-9));
}

TEST(SharedPose, IsNoneWhereTheRigWasMoved) {
  EXPECT_FALSE(shared_pose(std::array{solved(0, 25), solved(1, 25)}));
  EXPECT_FALSE(shared_pose(std::array{solved(0, 25), solved(0, 25.2)}));
}

TEST(SharedPose, IsNoneOfOneTurn) { EXPECT_FALSE(shared_pose(std::array{solved(0, 25)})); }

}  // namespace
}  // namespace octurn
