#include <cmath>

#include "calibrate/platform_plane.hpp"
#include "calibrate/platform_samples.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {
namespace {

// A platform of 28 cm, 0.7 m away, has a thousand samples; a large object leaves a few hundred.
constexpr std::size_t min_inliers = 200;
constexpr double min_share = 0.3;

}  // namespace

std::optional<PlatformSurface> measure_platform_surface(
    const DepthFrame& frame, const Intrinsics& intrinsics,
    const Eigen::Isometry3d& platform_from_sensor) {
  PlatformSamples samples = make_platform_samples(intrinsics, 1);
  samples.depths.front() = sample_depths(frame, intrinsics);
  const auto plane = fit_platform_plane(samples, platform_from_sensor);
  if (!plane || plane->inliers < min_inliers || plane->inlier_share < min_share) {
    return std::nullopt;
  }
  // On the plane normal . p = offset; with p = (0, 0, height) of the configured frame on the
  // configured axis.
  const Eigen::Vector3d normal = platform_from_sensor.linear() * plane->normal;
  const double offset = plane->offset + normal.dot(platform_from_sensor.translation());
  return PlatformSurface{.height = offset / normal.z(),
                         .slope = -normal.head<2>() / normal.z(),
                         .tilt = std::atan2(normal.head<2>().norm(), normal.z())};
}

}  // namespace octurn
