#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/platform_check.hpp"
#include "doctor/sensor_reading.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Whether frames come as fast as the sensor's mode says.
Finding check_frame_rate(const SensorSample& sample);

/// Whether frames were lost or damaged on the way.
Finding check_lost_frames(const SensorSample& sample);

/// Whether the sensor's tilt agrees with the calibration.
Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor);

/// All checks of the sensor. Without a sample the first says why, and the others are "unknown".
std::vector<Finding> check_sensor(const SensorReading& reading, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor);

}  // namespace octurn
