#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/stop_planes.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// A motion of the sensor between two stops, as seen in the platform's plane: tilt and height.
/// Shifts along the plane and a turn about its normal do not change it.
struct SensorStep {
  std::size_t stop = 0;  ///< the first after the motion
  double tilt = 0;       ///< radians
  double height = 0;     ///< metres, at the platform's middle: apparent rise of the platform
  double size = 0;       ///< metres: of tilt and height together, 10 cm from the middle
  double sigma = 0;      ///< metres, of the size
  double explained = 0;  ///< share of the sum of squares of the planes' differences
};

/// Finds the stop from which on the plane has moved: least squares for a step at each stop in turn,
/// together with a mean and the platform's wobble.
///
/// @param planes  of the stops
/// @param angles  radians, of the stops
/// @return nothing if there are no planes
std::optional<SensorStep> solve_sensor_step(const std::vector<StopPlane>& planes,
                                            const std::vector<double>& angles);

/// The finding "moved" of the sensor, if the step is large, certain, and not a slow drift.
std::optional<CalibrationFinding> find_bump(const SensorStep& step);

}  // namespace octurn
