#pragma once

#include <optional>
#include <vector>

#include "calibrate/stop_planes.hpp"

namespace octurn {

/// How far the platform's surface is from square to its shaft, radians.
struct PlatformWobble {
  double angle = 0;
  double sigma = 0;  ///< standard deviation, from how the stops differ
};

/// Measures the wobble: the tilt's direction turns with the platform.
///
/// @param planes  of the stops
/// @param angles  radians, of the stops
/// @return nothing if there are no planes
std::optional<PlatformWobble> measure_wobble(const std::vector<StopPlane>& planes,
                                             const std::vector<double>& angles);

}  // namespace octurn
