#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/sensor_look.hpp"
#include "octurn/box.hpp"

namespace octurn {

Finding check_frame_rate(const SensorSample& sample);

/// Whether frames are missing between those that came.
Finding check_lost_frames(const SensorSample& sample);

/// What a sensor sees of the platform: of those pixels whose rays meet its surface, inside the clip
/// box, by the calibration.
struct PlatformView {
  int rays = 0;        ///< pixels that look at it
  int readings = 0;    ///< those of them with a depth in at least half of the frames
  int on_surface = 0;  ///< those of them that see it within `surface_tolerance`
  double height = 0;   ///< of what they see above where the calibration has it, metres, median
  double noise = 0;    ///< two thirds of their depths are this near to their mean, metres
};

/// How far from the surface a reading still counts as one of it, metres.
inline constexpr double surface_tolerance = 0.015;

/// @param platform_from_sensor  the calibration
PlatformView view_of_platform(const SensorSample& sample, const Box& clip,
                              const Eigen::Isometry3d& platform_from_sensor);

/// Whether the platform is where the calibration has it.
Finding check_platform(const PlatformView& view);

Finding check_depth_noise(const PlatformView& view);

/// Whether the sensor stands as it did when it was calibrated.
Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor);

/// All of them, and whether there is a sensor at all.
std::vector<Finding> check_sensor(const SensorLook& look, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor);

}  // namespace octurn
