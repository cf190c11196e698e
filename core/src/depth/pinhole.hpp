#pragma once

#include <Eigen/Core>

#include "io/radial_distortion.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The ray of a pixel, optical frame, z = 1: multiplied by a depth it is the point.
inline Eigen::Vector3d to_ray(const Intrinsics& intrinsics, int u, int v) {
  return {(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1};
}

/// Projects a point to the image, pixels. @param point  optical frame, z > 0
inline Eigen::Vector2d project(const Intrinsics& intrinsics, const Eigen::Vector3d& point) {
  return {point.x() / point.z() * intrinsics.fx + intrinsics.cx,
          point.y() / point.z() * intrinsics.fy + intrinsics.cy};
}

/// A camera with distortion, to solve its optics.
struct DistortedCamera {
  Intrinsics pinhole = {};
  RadialDistortion distortion = {};

  /// The ray of a pixel, as above.
  Eigen::Vector3d ray(int u, int v) const {
    Eigen::Vector3d seen = to_ray(pinhole, u, v);
    if (distortion.k1 != 0) {
      seen.head<2>() *= distortion.undistorting_factor(seen.head<2>().norm());
    }
    return seen;
  }

  /// The pixel of a point, as above.
  Eigen::Vector2d pixel(Eigen::Vector3d point) const {
    if (distortion.k1 != 0) {
      point.head<2>() *= distortion.distorting_factor(point.head<2>().norm() / point.z());
    }
    return project(pinhole, point);
  }
};

}  // namespace octurn
