#include "calibrate/platform_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/calibrate/rendered_turn.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Returns where a ray of the platform's frame meets the scene, in lengths of `direction` from
/// `origin`; 0 is no reading.
using Scene = std::function<double(const Vector3d& origin, const Vector3d& direction)>;

/// A disc of 30 cm at the platform's height, or a smaller one above it.
double to_disc(const Vector3d& origin, const Vector3d& direction, double height, double radius) {
  const double z = (height - origin.z()) / direction.z();
  const bool meets = z > 0 && (origin + z * direction).head<2>().norm() < radius;
  return meets ? z : 0;
}

double bare_platform(const Vector3d& origin, const Vector3d& direction) {
  return to_disc(origin, direction, 0, 0.15);
}

PlatformSamples sampled(const Scene& scene, std::size_t stops) {
  const Eigen::Isometry3d pose = true_platform_from_sensor();
  PlatformSamples samples{.columns = 160, .rays = {}, .depths = {}};
  std::vector<float> depths;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      samples.rays.emplace_back((u - 80) / 144.0, (v - 60) / 144.0, 1);
      const Vector3d direction = pose.linear() * samples.rays.back();
      depths.push_back(static_cast<float>(scene(pose.translation(), direction)));
    }
  }
  samples.depths.assign(stops, depths);
  return samples;
}

/// Expects the plane to be the platform's true one, in angle and in height.
void expect_true(const std::optional<PlatformPlane>& plane) {
  ASSERT_TRUE(plane);
  const Vector3d up = true_platform_from_sensor().linear() * plane->normal;
  // Readings are floats, rounded by 0.03 micrometres at 0.6 m.
  EXPECT_LT(degrees_from_radians(up.head<2>().norm()), 0.001);
  EXPECT_NEAR(plane->height(true_platform_from_sensor().inverse().translation()), 0, 1e-6);
}

TEST(PlatformPlane, IsFoundFromAToldPoseThatIsWrong) {
  const auto plane = fit_platform_plane(sampled(bare_platform, 4),
                                        wrong_pose({0.02, -0.01, 0.015}, {1, 0.5, 0}, 4));

  expect_true(plane);
  EXPECT_GT(plane->inlier_share, 0.99);
}

TEST(PlatformPlane, IsTheLowestOfThoseThatAreLarge) {
  const Scene lid_over_platform = [](const Vector3d& origin, const Vector3d& direction) {
    const double lid = to_disc(origin, direction, 0.012, 0.11);
    return lid > 0 ? lid : bare_platform(origin, direction);
  };

  expect_true(
      fit_platform_plane(sampled(lid_over_platform, 4), wrong_pose({0, 0, 0.008}, {1, 0, 0}, 1)));
}

TEST(PlatformPlane, IsFittedToPixelsThatNeverSeeTheObject) {
  // At one stop of three a slab 8 mm high hides the left half.
  PlatformSamples samples = sampled(bare_platform, 3);
  const PlatformSamples slab = sampled(
      [](const Vector3d& origin, const Vector3d& direction) {
        const double z = to_disc(origin, direction, 0.008, 0.15);
        return z > 0 && (origin + z * direction).x() < 0 ? z : bare_platform(origin, direction);
      },
      1);
  samples.depths[1] = slab.depths[0];

  expect_true(fit_platform_plane(samples, true_platform_from_sensor()));
}

TEST(PlatformPlane, IsNotFoundWhereNothingIsRead) {
  EXPECT_FALSE(fit_platform_plane(sampled([](const Vector3d&, const Vector3d&) { return 0.0; }, 3),
                                  true_platform_from_sensor()));
}

TEST(Level, PutsThePlaneAtZeroByTheLeastRotation) {
  const auto plane = fit_platform_plane(sampled(bare_platform, 2), true_platform_from_sensor());
  ASSERT_TRUE(plane);
  const Eigen::Isometry3d told = wrong_pose({0.01, 0.02, -0.01}, {1, 1, 0}, 3);

  const Eigen::Isometry3d levelled = level(told, *plane);

  const Vector3d up = levelled.linear() * plane->normal;
  EXPECT_NEAR(up.z(), 1, 1e-12);
  EXPECT_NEAR((levelled * (plane->normal * plane->offset)).z(), 0, 1e-12);
  const Eigen::AngleAxisd turn(levelled.linear() * told.linear().transpose());
  EXPECT_NEAR(degrees_from_radians(turn.angle()), 3, 0.001);  // the plane is told 3 degrees off
  EXPECT_NEAR(turn.axis().z(), 0, 1e-9);
}

}  // namespace
}  // namespace octurn
