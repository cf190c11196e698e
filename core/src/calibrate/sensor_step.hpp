#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/stop_planes.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// A motion of the sensor against the platform between two stops, as far as the plane tells it:
/// not along the plane, nor a turn about its normal.
struct SensorStep {
  std::size_t stop = 0;  ///< the first at which it stood elsewhere
  double tilt = 0;       ///< radians
  double height = 0;     ///< metres, at the platform's middle: what it sees the platform rise by
  double size = 0;       ///< metres: of both, 10 cm from the middle
  double sigma = 0;      ///< metres, of the size
  double explained = 0;  ///< of the sum of squares by which the planes of the stops differ
};

/// Finds the stop from which on the plane lies elsewhere, by least squares beside a wobble of the
/// platform, which goes round with it.
///
/// @param planes  of the stops
/// @param angles  radians, of the stops
/// @return nothing if there are no planes
std::optional<SensorStep> solve_sensor_step(const std::vector<StopPlane>& planes,
                                            const std::vector<double>& angles);

/// What a step says: that the sensor moved, if it is large, certain, and no slow change.
std::optional<CalibrationFinding> find_bump(const SensorStep& step);

}  // namespace octurn
