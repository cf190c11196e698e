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

/// Measures the plane at each stop, from the pixels that see it at all of them: what a sensor's
/// fixed error makes wrong is the same at each, and cancels. The change from the mean is fitted in
/// inverse depth, in which a plane is linear.
///
/// @param is_plane  as `find_plane_pixels` tells
/// @param levelled  platform_from_sensor, in which `plane` is z = 0
/// @return of each stop; empty if there are fewer than six, or too little of the platform is seen
std::vector<StopPlane> measure_stop_planes(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane,
                                           const Eigen::Isometry3d& levelled);

}  // namespace octurn
