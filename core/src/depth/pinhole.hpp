#pragma once

#include <Eigen/Core>

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

}  // namespace octurn
