#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "doctor/finding.hpp"
#include "doctor/sensor_reading.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The platform as the sensor measures it. Counts pixels whose rays, by the calibration, meet the
/// platform's surface inside the clip box.
struct PlatformView {
  int rays = 0;        ///< pixels whose rays meet the platform
  int readings = 0;    ///< of `rays`: with a depth in at least half of the frames
  int on_surface = 0;  ///< of `readings`: within `surface_tolerance` of the platform
  double noise = 0;    ///< standard deviation of a pixel's depths, metres (68.3 % quantile)
  /// The plane fitted to readings near the platform; nothing if there is none.
  std::optional<PlatformSurface> surface = {};
};

/// Maximum height of a reading above or below the platform that still counts as its surface,
/// metres.
inline constexpr double surface_tolerance = 0.015;

inline constexpr Check platform_check{"platform", "Platform"};
inline constexpr Check depth_noise_check{"depth-noise", "Depth noise"};

/// Measures the platform in the frames of a sample.
/// @param platform_from_sensor  the calibration
PlatformView measure_platform(const SensorSample& sample, const Box& clip,
                              const Eigen::Isometry3d& platform_from_sensor);

/// Whether the platform is as high and as level as the calibration says.
Finding check_platform(const PlatformView& view);

/// Whether the depth noise on the platform is as low as a Kinect's.
Finding check_depth_noise(const PlatformView& view);

}  // namespace octurn
