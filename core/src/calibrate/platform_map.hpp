#pragma once

#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"

namespace octurn {

/// How uneven a flat platform looks, on average over all stops: what a sensor reads wrong at each
/// pixel, and always.
///
/// The inverse depth of a plane is linear in the image, and a Kinect's disparity is linear in
/// inverse depth. So the differences are in its units, 1/345.489 m^-1, and of blocks of 32 x 32
/// pixels: noise averages out in them.
/// @param is_plane  as `find_plane_pixels` tells
/// @return the root mean square of the blocks; nothing if too little of the platform is seen
std::optional<double> measure_platform_map(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane);

}  // namespace octurn
