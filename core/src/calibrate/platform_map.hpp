#pragma once

#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"

namespace octurn {

/// Measures how uneven a flat platform looks on average over all stops: the fixed pattern of the
/// sensor's errors.
///
/// The inverse depth of a plane is linear in the image, and a Kinect's disparity is linear in
/// inverse depth. The differences are in its units, 1/345.489 m^-1, and averaged over blocks of
/// 32 x 32 pixels to remove noise.
/// @param is_plane  of `find_plane_pixels`
/// @return the root mean square of the blocks; nothing if too little of the platform is seen
std::optional<double> measure_platform_map(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane);

}  // namespace octurn
