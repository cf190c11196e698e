#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "calibrate/sensor_step.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// Findings from the platform's surface.
struct SurfaceFindings {
  std::optional<SensorStep> bump = {};    ///< of the sensor
  std::optional<double> unevenness = {};  ///< units of disparity; nothing if too little is seen
};

/// Adds the finding "wobble" if the platform tilts as it turns. A bump of the sensor replaces all
/// findings before it: it looks like a slip, or a move of the object.
/// @param angles    radians, of the stops
/// @param levelled  the pose in which the plane is z = 0
SurfaceFindings look_at_surface(CalibrationReport& report, const PlatformSamples& samples,
                                const PlatformPlane& plane, const std::vector<double>& angles,
                                const Eigen::Isometry3d& levelled);

/// Adds the finding "no-map" if the platform looks uneven.
/// @param unevenness  units of disparity
void add_no_map(CalibrationReport& report, double unevenness);

}  // namespace octurn
