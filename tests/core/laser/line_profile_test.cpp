#include "laser/line_profile.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "io/radial_distortion.hpp"

namespace octurn {
namespace {

const Intrinsics narrow_lens{
    .width = 200, .height = 150, .fx = 330, .fy = 320, .cx = 99.5, .cy = 70};

TEST(RadialDistortion, IsTakenOut) {
  for (const RadialDistortion bent :
       {RadialDistortion{-0.3, 0.08}, RadialDistortion{0.2, -0.03}, RadialDistortion{0, 0}}) {
    for (double r = 0; r < 0.7; r += 0.05) {
      const double seen = r * (1 + bent.k1 * r * r + bent.k2 * r * r * r * r);
      EXPECT_NEAR(seen * bent.undistorting_factor(seen), r, 1e-9);
    }
  }
}

TEST(RadialDistortion, KnowsWhereItFoldsOver) {
  // r (1 - 0.5 r^2) is largest at r = sqrt(2/3), where it is 0.544.
  const RadialDistortion folding{.k1 = -0.5};
  EXPECT_TRUE(folding.is_invertible_to(0.5));
  EXPECT_FALSE(folding.is_invertible_to(0.56));
  EXPECT_TRUE(RadialDistortion{}.is_invertible_to(10));
}

TEST(LineProfile, HasTheRaysOfWhatTheCameraSees) {
  const LaserCamera camera{.k1 = -0.12, .k2 = 0.03};
  const Laser laser{.normal = Eigen::Vector3d(0.8, 0.1, -0.59).normalized(), .distance = -0.17};
  std::vector<LineSample> samples;
  std::vector<Eigen::Vector3d> truth;
  for (int row = 10; row < 140; row += 7) {
    // Bisection for the point of a straight line in the laser's plane that the narrow_lens shows on
    // `row`.
    const Eigen::Vector3d along = laser.normal.cross(Eigen::Vector3d(1, 0, 0)).normalized();
    const Eigen::Vector3d foot =
        laser.normal * laser.distance + Eigen::Vector3d(0.59, 0, 0.8) * 0.2;
    const auto seen = [&](double at) -> Eigen::Vector2d {
      const Eigen::Vector3d p = foot + along * at;
      const Eigen::Vector2d ideal = p.head<2>() / p.z();
      const double square = ideal.squaredNorm();
      const Eigen::Vector2d bent = ideal * (1 + camera.k1 * square + camera.k2 * square * square);
      return {bent.x() * narrow_lens.fx + narrow_lens.cx,
              bent.y() * narrow_lens.fy + narrow_lens.cy};
    };
    double low = -0.2;
    double high = 0.2;
    const bool rising = seen(high).y() > seen(low).y();
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      ((seen(middle).y() < row) == rising ? low : high) = middle;
    }
    samples.push_back({.u = static_cast<float>(seen(low).x()), .light = 1, .row = row});
    truth.push_back(foot + along * low);
  }

  const LineProfile profile = to_profile(samples, narrow_lens, camera);

  ASSERT_EQ(profile.rays.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(profile.row(samples[i].row).size(), 1U);
    EXPECT_LT((meet(profile.rays[i], laser) - truth[i]).norm(), 2e-6);  // columns are floats
  }
}

TEST(LineProfile, MeetsNoPlaneBehindTheCameraOrAlongTheRay) {
  const LineProfile::Ray ray{.x = 0.1F, .y = 0};
  const Laser behind{.normal = Eigen::Vector3d::UnitZ(), .distance = -0.3};
  const Laser along{.normal = Eigen::Vector3d(1, 0, -0.1).normalized(), .distance = 0.3};
  EXPECT_FALSE(meet(ray, behind).allFinite());
  EXPECT_FALSE(meet(ray, along).allFinite());
}

}  // namespace
}  // namespace octurn
