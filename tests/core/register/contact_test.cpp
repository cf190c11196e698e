#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "register/reading_fit.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Points 2 mm apart on a face of 4 cm x 4 cm whose normal points down.
std::vector<SurfacePoint> face(const std::function<double(double, double)>& height) {
  std::vector<SurfacePoint> points;
  for (int i = -10; i < 10; ++i) {
    for (int j = -10; j < 10; ++j) {
      const double x = i * 0.002;
      const double y = j * 0.002;
      const double step = 1e-5;
      const Vector3d normal((height(x + step, y) - height(x, y)) / step,
                            (height(x, y + step) - height(x, y)) / step, -1);
      points.push_back({.point = {x, y, height(x, y)}, .normal = normal.normalized()});
    }
  }
  return points;
}

const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();

TEST(Contact, IsAFlatFaceNearThePlatform) {
  const auto points = face([](double, double) { return 0.008; });

  const Contact contact = find_contact(points, here, 1);

  EXPECT_EQ(contact.foot.size(), points.size());
}

TEST(Contact, IsNoneFarFromThePlatform) {
  EXPECT_TRUE(find_contact(face([](double, double) { return 0.02; }), here, 1).foot.empty());
}

// A ball touches the platform at one point, 0.25 mm below the mean of the cap within 8 degrees.
TEST(Contact, IsNoneOfABall) {
  const auto points =
      face([](double x, double y) { return 0.05 - std::sqrt(0.0025 - x * x - y * y); });

  EXPECT_TRUE(find_contact(points, here, 1).foot.empty());
}

// A bowl stands on its foot ring, and its flat bottom is 3 mm above the platform.
TEST(Contact, IsNoneOfAHollowFoot) {
  auto points = face([](double, double) { return 0.003; });
  for (int i = 0; i < 40; ++i) {
    points.push_back({.point = {0.025, 0.001 * i, 0}, .normal = -Vector3d::UnitZ()});
  }

  EXPECT_TRUE(find_contact(points, here, 1).foot.empty());
}

// For a face 3 mm too high, either the object's foot moves down, or the platform of the turn being
// fitted moves up.
TEST(Contact, MovesTheFootOrThePlatform) {
  const Contact contact = find_contact(face([](double, double) { return 0.003; }), here, 1);
  RigidFit foot;
  RigidFit platform;

  add_moving_foot(foot, contact, here, 1);
  add_moving_platform(platform, contact, here, 1);

  // Unconstrained directions are damped by a ten-thousandth of the weight.
  EXPECT_TRUE(foot.motion().translation().isApprox(Vector3d(0, 0, -0.003), 1e-3));
  EXPECT_TRUE(platform.motion().translation().isApprox(Vector3d(0, 0, 0.003), 1e-3));
}

}  // namespace
}  // namespace octurn
