#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/stop_planes.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// A motion of the sensor against the platform between two stops: the tilt and the height that the
/// platform's plane shows. Shifts along the plane and a turn about its normal leave no trace in it.
struct SensorStep {
  std::size_t stop = 0;  ///< the first at which it stood elsewhere
  double tilt = 0;       ///< radians
  double height = 0;     ///< metres, at the platform's middle: what it sees the platform rise by
  double size = 0;       ///< metres: of both, 10 cm from the middle
  double sigma = 0;      ///< metres, of the size
  double explained = 0;  ///< of the sum of squares by which the planes of the stops differ
};

/// Finds the stop from which on the plane lies elsewhere: least squares over a step at each stop in
/// turn, together with a mean and a wobble of the platform, which turns with it.
///
/// @param planes  of the stops
/// @param angles  radians, of the stops
/// @return nothing if there are no planes
std::optional<SensorStep> solve_sensor_step(const std::vector<StopPlane>& planes,
                                            const std::vector<double>& angles);

/// What a step says: that the sensor moved, if it is large, certain, and no slow change.
std::optional<CalibrationFinding> find_bump(const SensorStep& step);

}  // namespace octurn
