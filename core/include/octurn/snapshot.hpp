#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

namespace octurn {

/// An axis-aligned box, its faces included.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

inline bool contains(const Box& box, const Eigen::Vector3d& point) {
  return (point.array() >= box.min.array()).all() && (point.array() <= box.max.array()).all();
}

/// One image from a depth sensor.
struct DepthFrame {
  int width = 0;                          ///< pixels
  int height = 0;                         ///< pixels
  std::vector<std::uint16_t> depth = {};  ///< width x height, row by row from the top left, in the
                                          ///< sensor's depth unit; 0 is no reading
};

/// A pinhole depth camera. The defaults are a Kinect v1's nominal ones (field of view 58.1 x 45.3
/// degrees) with depth in tenths of a millimetre.
///
/// A sample (u, v) of value d lies at p = ((u - cx) z / fx, (v - cy) z / fy, z) with
/// z = d * depth_unit, in the optical frame: X right, Y down, Z forward, metres.
struct Intrinsics {
  int width = 640;    ///< pixels
  int height = 480;   ///< pixels
  double fx = 575.8;  ///< focal lengths, pixels
  double fy = 575.8;
  double cx = 320.0;  ///< principal point, pixels; (0, 0) is the middle of the top left sample
  double cy = 240.0;
  double depth_unit = 0.0001;  ///< metres

  bool operator==(const Intrinsics&) const = default;
};

/// What a kind of sensor can do. The defaults are a Kinect v1's, whose noise grows with the square
/// of the distance.
struct SensorTraits {
  bool sees_lines = false;  ///< of lasers
  double nearest = 0.5;     ///< metres: nearer surfaces have no readings
  double best_near = 0.6;   ///< metres: where scans are most accurate
  double best_far = 0.9;
  double farthest = 1.2;  ///< metres: a step of depth is 4 mm there
  /// Metres, at a distance of 1 m: above it, two stops disagree by more than noise explains. Those
  /// of a correct rig disagree by 0.5 to 0.7 mm at 0.65 m.
  double disagreement_at_1_m = 0.0026;
  double noise_distance = 0.65;   ///< metres: closer, other errors are larger than the noise
  double truncation = 0.0035;     ///< metres, for `SolidOptions::truncation`: 3 sigma of the noise
  double leaf_size = 0.001;       ///< metres, of models
  double target_error = 0.00004;  ///< metres, for `ReconstructOptions::target_error`
  int stops = 36;                 ///< of a turn
};

/// Of a camera with line lasers. The truncation follows from the spacing of the lines, one or two
/// millimetres, and not from the noise, 0.05 to 0.2 mm: with a thinner band behind the surface
/// inside cannot be known from outside between two lines.
inline constexpr SensorTraits laser_traits{.sees_lines = true,
                                           .truncation = 0.002,
                                           .leaf_size = 0.0005,
                                           .target_error = 0.00001,
                                           .stops = 200};

/// The traits of a depth sensor. @param name  as OpenNI2 has it; a Kinect's for others
const SensorTraits& sensor_traits(std::string_view name);

/// The optics of one depth sensor as measured. They replace its data sheet's.
///
/// Distortion is Brown's on normalised coordinates: what a pinhole camera would see at x appears at
/// x (1 + k1 r^2 + k2 r^4). The true inverse depth is (the sensor's + depth_offset_per_m) /
/// depth_scale.
struct SensorOptics {
  double fx = 575.8;  ///< focal lengths, pixels
  double fy = 575.8;
  double cx = 320.0;  ///< principal point, pixels
  double cy = 240.0;
  double k1 = 0;
  double k2 = 0;
  double depth_scale = 1;
  double depth_offset_per_m = 0;  ///< 1/m

  bool operator==(const SensorOptics&) const = default;
};

/// Measured optics, and the standard deviation of each member.
struct SolvedOptics {
  SensorOptics value = {};
  SensorOptics sigma = {};
};

/// The pinhole camera of depth images that were rectified for these optics.
/// @param sensor  as the sensor tells
Intrinsics rectified(Intrinsics sensor, const SensorOptics& optics);

/// Takes distortion and depth offset out of a depth image: it is then one of the pinhole camera
/// above, in whose depth unit the scale is. Depths are interpolated between neighbouring readings
/// of one surface, so that rectified surfaces have no steps.
/// @param sensor  as the sensor tells
/// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
DepthFrame rectified(DepthFrame frame, const Intrinsics& sensor, const SensorOptics& optics);

/// How the frames of one still scene are merged into one depth image (Bennett 2014).
enum class DepthFilter {
  basic,            ///< the first frame, unchanged
  average,          ///< at each pixel the mean of the readings
  average_discard,  ///< the same, but no reading where any frame has none
};

/// The filter's name in settings and files: "basic", "average", "average-discard".
std::string_view to_string(DepthFilter filter);

/// The filter of that name, if there is one.
std::optional<DepthFilter> depth_filter_named(std::string_view name);

/// Merges frames of one still scene into one depth image. Means are rounded to the nearest depth
/// unit, halves up.
///
/// @param frames  at least one, all of one size
/// @throws std::invalid_argument  if there is no frame, or the frames' sizes differ
DepthFrame merge_frames(std::span<const DepthFrame> frames, DepthFilter filter);

/// Whether a matrix is a rotation and a translation and nothing else, within the rounding of
/// decimals in a file: |R R^T - 1| <= 1e-4, det R > 0, last row (0, 0, 0, 1).
bool is_rigid(const Eigen::Matrix4d& matrix);

/// The pose of the sensor in the frame of an object that turns with the platform.
///
/// The object's frame is the platform's at angle 0: right-handed, Z up, metres, origin at the
/// platform's centre on its surface.
///
/// @param platform_from_sensor  the calibration: optical frame to platform frame, metres
/// @param angle                 of the platform, radians, counter-clockwise seen from above
/// @return Rz(-angle) * platform_from_sensor
Eigen::Isometry3d object_from_sensor(const Eigen::Isometry3d& platform_from_sensor, double angle);

/// The surface between a laser's line at one stop of the platform and its lines at the stops before
/// and after: triangles that join neighbouring rows of the picture and neighbouring lines.
struct LineStrip {
  using Triangle = std::array<std::uint32_t, 3>;  ///< indices of points

  std::vector<Eigen::Vector3f> points = {};  ///< metres, object's frame
  std::size_t own_points = 0;  ///< the first points are of this stop's line, the others of its two
                               ///< neighbours'
  std::vector<Triangle> to_previous = {};
  std::vector<Triangle> to_next = {};  ///< the same surface as `to_previous` of the next stop
  std::optional<Eigen::Vector3d> source = {};  ///< metres, object's frame: the laser, if known
};

/// The measurement at one stop of the platform: a filtered, unclipped depth image and its pose. By
/// laser line, strips of surface replace the image.
struct Snapshot {
  DepthFrame frame = {};  ///< of the intrinsics' size; empty by laser line
  Intrinsics intrinsics = {};
  /// Optical frame to the object's frame, metres; see the function of this name.
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();
  int pose = 0;                        ///< index of the object's pose, 0 if there is only one
  std::vector<LineStrip> strips = {};  ///< one for each laser; empty for a depth sensor
};

/// The object's pose on the platform, in one of several turns.
struct Placement {
  /// Platform frame of the pose, at angle 0, to the object's frame, metres.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  Box clip = {};  ///< metres, platform frame of the pose
};

/// Snapshots that several threads can read at once, any number of times.
struct SnapshotSource {
  std::size_t count = 0;
  std::function<Snapshot(std::size_t)> read = {};  ///< takes an index below `count`
};

/// Thrown by a call whose stop token was requested to stop before it had a result. A source or a
/// sink may throw it to end a reconstruction. It is not an `Error`: nothing went wrong.
struct Stopped {};

/// @throws Stopped  if a stop was requested
inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) {
    throw Stopped{};
  }
}

}  // namespace octurn
