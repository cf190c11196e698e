#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibrate/platform_plane.hpp"

namespace octurn {

/// The platform's plane as one stop sees it, less the mean over all stops.
struct StopPlane {
  Eigen::Vector2d tilt =
      Eigen::Vector2d::Zero();  ///< radians: its normal's x and y, platform frame
  double height = 0;            ///< metres, at the platform's middle
};

/// Measures the plane at each stop from the pixels that see it at every stop. The sensor's fixed
/// error is the same at each stop, and cancels. The change from the mean is fitted in inverse
/// depth, in which a plane is linear.
///
/// @param is_plane  of `find_plane_pixels`
/// @param levelled  platform_from_sensor, in which `plane` is z = 0
/// @return one for each stop; empty if there are fewer than six, or too little of the platform is
///         seen
std::vector<StopPlane> measure_stop_planes(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane,
                                           const Eigen::Isometry3d& levelled);

}  // namespace octurn
