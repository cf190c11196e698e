#pragma once

#include <Eigen/Core>

#include "octurn/snapshot.hpp"

namespace octurn {

/// The ray of a pixel by the pinhole model, optical frame, z = 1: a depth along Z (metres) times
/// the ray is the point.
inline Eigen::Vector3d pixel_ray(const Intrinsics& lens, int u, int v) {
  return {(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1};
}

}  // namespace octurn
