#pragma once

#include <Eigen/Geometry>
#include <string_view>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/platform_check.hpp"
#include "doctor/sensor_reading.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Whether frames come as fast as the sensor's mode says.
Finding check_frame_rate(const SensorSample& sample);

/// Whether frames or packets were lost on the way.
/// @param board  the machine's, such as "Raspberry Pi 4 Model B Rev 1.4"; empty if it is unknown
Finding check_lost_frames(const SensorSample& sample, std::string_view board = {});

/// Whether the sensor's tilt agrees with the calibration.
Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor);

/// All checks of the sensor. Without a sample the first says why, and the others are "unknown".
/// @param board  as above
std::vector<Finding> check_sensor(const SensorReading& reading, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor,
                                  std::string_view board = {});

}  // namespace octurn
