#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"

namespace octurn {

/// How far the platform's surface is from square to its shaft, radians.
struct PlatformWobble {
  double angle = 0;
  double sigma = 0;  ///< standard deviation, from how the stops differ
};

/// Such a surface tilts another way at each stop: its normal goes round with the platform. The
/// plane's change from the mean over all stops is fitted in inverse depth, in which a plane is
/// linear. A sensor's fixed error is the same at all stops, and cancels.
///
/// @param is_plane  as `find_plane_pixels` tells
/// @param angles  radians, of the stops
/// @param levelled  platform_from_sensor, in which `plane` is z = 0
/// @return nothing if there are too few stops, or too little of the platform is seen at all of them
std::optional<PlatformWobble> measure_wobble(const PlatformSamples& samples,
                                             const PlatformPlane& plane,
                                             const std::vector<bool>& is_plane,
                                             const std::vector<double>& angles,
                                             const Eigen::Isometry3d& levelled);

}  // namespace octurn
