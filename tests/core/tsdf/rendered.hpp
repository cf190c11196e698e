#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "octurn/reconstruct.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"

namespace octurn {

/// Signed distance of a point (metres, platform frame) to an object, positive outside, or a lower
/// bound of it.
using Shape = std::function<double(const Eigen::Vector3d&)>;

inline Shape ball(const Eigen::Vector3d& centre, double radius) {
  return [=](const Eigen::Vector3d& p) { return (p - centre).norm() - radius; };
}

/// A block that stands on the platform.
inline Shape block(const Eigen::Vector3d& size) {
  return [=](const Eigen::Vector3d& p) {
    const Eigen::Array3d out =
        (p - Eigen::Vector3d(0, 0, size.z() / 2)).array().abs() - size.array() / 2;
    return out.max(0.0).matrix().norm() + std::min(out.maxCoeff(), 0.0);
  };
}

/// A block with half a ball hollowed out of its top.
inline Shape hollowed_block(const Eigen::Vector3d& size, double radius) {
  return [whole = block(size), gap = ball({0, 0, size.z()}, radius)](const Eigen::Vector3d& p) {
    return std::max(whole(p), -gap(p));
  };
}

/// A ray of the platform's frame: `origin + z * direction`, where `z` is the depth.
struct DepthRay {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

/// The depth at which a ray meets a shape, or `end` if that is farther (Hart 1996, "Sphere
/// tracing").
inline double depth_along(const DepthRay& ray, const Shape& shape, double begin, double end) {
  const double length = ray.direction.norm();
  double z = begin;
  for (double gap = 1; gap > 1e-5 && z < end;) {
    gap = shape(ray.origin + z * ray.direction);
    z += gap / length;
  }
  return std::min(z, end);
}

/// A scan of a shape by an ideal sensor of 240 x 180 samples, 0.7 m away and 25 degrees above. Each
/// ray ends on the shape or on the platform.
inline SnapshotSource rendered(const Shape& shape, std::size_t count) {
  return {.count = count, .read = [=](std::size_t i) {
            Eigen::Matrix3d upright;  // optical X right, Y down, Z forward, in the platform's axes
            upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
            Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
            pose.linear() =
                Eigen::AngleAxisd(radians_from_degrees(-25), Eigen::Vector3d::UnitX()) * upright;
            pose.translation() = Eigen::Vector3d(0, -0.6, 0.34);
            const double angle =
                2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
            Snapshot snapshot{.frame = {.width = 240, .height = 180, .depth = {}},
                              .intrinsics = {.width = 240,
                                             .height = 180,
                                             .fx = 216,
                                             .fy = 216,
                                             .cx = 120,
                                             .cy = 90,
                                             .depth_unit = 0.0001},
                              .object_from_sensor = object_from_sensor(pose, angle)};
            const Eigen::Isometry3d& from_sensor = snapshot.object_from_sensor;
            for (int v = 0; v < 180; ++v) {
              for (int u = 0; u < 240; ++u) {
                const Eigen::Vector3d through((u - 120) / 216.0, (v - 90) / 216.0, 1);
                const DepthRay ray{.origin = from_sensor.translation(),
                                   .direction = from_sensor.linear() * through};
                const double to_platform =
                    ray.direction.z() < 0 ? -ray.origin.z() / ray.direction.z() : 1.2;
                const double z = depth_along(ray, shape, 0.4, std::min(to_platform, 1.2));
                snapshot.frame.depth.push_back(
                    static_cast<std::uint16_t>(z < 1.2 ? std::lround(z / 0.0001) : 0));
              }
            }
            return snapshot;
          }};
}

}  // namespace octurn
