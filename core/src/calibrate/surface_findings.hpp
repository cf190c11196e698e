#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The platform's plane as one stop sees it, less the mean over all stops.
struct StopPlane {
  Eigen::Vector2d tilt =
      Eigen::Vector2d::Zero();  ///< radians: its normal's x and y, platform frame
  double height = 0;            ///< metres, at the platform's middle
};

/// Measures the plane at each stop from the pixels that see it at every stop. The sensor's fixed
/// error is the same at each stop, and cancels. The change from the mean is fitted in inverse
/// depth, in which a plane is linear.
///
/// @param is_plane  of `find_plane_pixels`
/// @param levelled  platform_from_sensor, in which `plane` is z = 0
/// @return one for each stop; empty if there are fewer than six, or too little of the platform is
///         seen
std::vector<StopPlane> measure_stop_planes(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane,
                                           const Eigen::Isometry3d& levelled);

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

/// Measures how uneven a flat platform looks on average over all stops: the fixed pattern of the
/// sensor's errors.
///
/// The inverse depth of a plane is linear in the image, and a Kinect's disparity is linear in
/// inverse depth. The differences are in its units, 1/345.489 m^-1, and averaged over blocks of
/// 32 x 32 pixels to remove noise.
/// @param is_plane  of `find_plane_pixels`
/// @return the root mean square of the blocks; nothing if too little of the platform is seen
std::optional<double> measure_platform_map(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane);

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
