#pragma once

#include <Eigen/Geometry>

#include "octurn/depth_frame.hpp"
#include "octurn/intrinsics.hpp"

namespace octurn {

/// What one stop of the platform gave: the filtered, unclipped depth, and where it was seen from.
struct Snapshot {
  DepthFrame frame = {};
  Intrinsics intrinsics = {};
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();
};

}  // namespace octurn
