#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/sensor_reading.hpp"
#include "octurn/box.hpp"

namespace octurn {

/// Whether frames come as fast as the sensor's mode says.
Finding check_frame_rate(const SensorSample& sample);

/// Whether frames were lost or damaged on the way.
Finding check_lost_frames(const SensorSample& sample);

/// What the sensor sees of the platform. Counts pixels whose rays, by the calibration, meet the
/// platform's surface inside the clip box.
struct PlatformView {
  int rays = 0;        ///< pixels whose rays meet the platform
  int readings = 0;    ///< of `rays`: with a depth in at least half of the frames
  int on_surface = 0;  ///< of `readings`: within `surface_tolerance` of the platform
  double height = 0;   ///< median height of `on_surface` above the calibrated platform, metres
  double noise = 0;    ///< standard deviation of a pixel's depths, metres (68.3 % quantile)
};

/// Maximum height of a reading above or below the platform that still counts as its surface,
/// metres.
inline constexpr double surface_tolerance = 0.015;

/// Measures the platform in the frames of a sample.
/// @param platform_from_sensor  the calibration
PlatformView measure_platform(const SensorSample& sample, const Box& clip,
                              const Eigen::Isometry3d& platform_from_sensor);

/// Whether the platform is where the calibration says.
Finding check_platform(const PlatformView& view);

/// Whether the depth noise on the platform is as low as a Kinect's.
Finding check_depth_noise(const PlatformView& view);

/// Whether the sensor's tilt agrees with the calibration.
Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor);

/// All checks of the sensor. Without a sample the first says why, and the others are "unknown".
std::vector<Finding> check_sensor(const SensorReading& reading, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor);

}  // namespace octurn
