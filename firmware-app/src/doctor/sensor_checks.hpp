#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "capture/rig.hpp"
#include "doctor/finding.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/snapshot.hpp"
#include "rig/kinect_device.hpp"
#include "store/job.hpp"

namespace octurn {

/// Frames and properties of a sensor, taken for about two seconds.
struct SensorSample {
  std::string name = {};
  std::string serial = {};
  Intrinsics intrinsics = {};
  std::vector<std::chrono::steady_clock::time_point> times = {};  ///< of each frame
  std::optional<PacketCounts> packets = {};  ///< nothing if the sensor does not count them
  std::vector<DepthFrame> frames = {};       ///< the last ones, of a scene that stands still
  std::optional<Tilt> tilt = {};
};

/// A camera with lasers that sees the lines of all of them.
struct CameraSample {
  std::string name = {};
  int width = 0;  ///< pixels
  int height = 0;
  std::vector<std::string> lasers = {};  ///< their names
};

/// A sample, or why there is none. The code "busy" says that the sensor is in use.
using SensorReading = std::variant<SensorSample, CameraSample, Failure>;

/// Reads frames for about two seconds, or takes a picture with each laser where the platform
/// stands; "busy" if `stop` is requested before. Closes a sensor that fails.
SensorReading read_sensor(Rig& rig, const std::stop_token& stop);

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
