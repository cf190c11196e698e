#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "depth/pinhole.hpp"
#include "depth/seen_pixels.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// One reading of a surface, optical frame, metres.
struct SurfaceReading {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< as read: a smoothed one would be biased
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of length one, towards the sensor
};

/// Least cosine between two normals of one surface.
inline constexpr double min_normal_agreement = 0.7;

/// Height of the volume of objects on the platform, metres.
inline constexpr double max_object_height = 0.4;

/// With fewer pixels at a stop, an object is too small: 2 cm at 0.7 m.
inline constexpr double min_object_pixels = 120;

/// Pixels that share the sensor's error, about 7 x 7. Errors of longer range are fixed, and cancel
/// in the difference of two depth images.
inline constexpr double correlated_pixels = 50;

/// The rectangle of a stop's depth image that shows the object.
class ObjectView {
 public:
  /// Readings of the object are high enough above the platform and near enough to its axis.
  struct Mask {
    PlatformPlane plane = {};
    Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();  ///< metres, optical frame
    double min_height = 0.004;  ///< metres above the platform, whose noise is below
    bool contains(const Eigen::Vector3d& point) const;
  };

  /// @throws std::invalid_argument  if the image has another size than the intrinsics say
  ObjectView(const DepthFrame& frame, const Intrinsics& intrinsics, const Mask& mask);

  /// Number of the object's pixels.
  int pixels() const { return window_.pixels; }

  /// The reading at the pixel to which a point projects.
  /// @return nothing without a reading, near a depth edge, or at a grazing angle
  std::optional<SurfaceReading> look_up(const Eigen::Vector3d& point) const;

  /// Reads the same image with other optics. @param camera  of the same size and depth unit
  void set_camera(const DistortedCamera& camera, const Mask& mask);

  /// The object's readings at every `step`-th pixel.
  std::vector<SurfaceReading> readings(int step) const;

 private:
  std::optional<SurfaceReading> read(int u, int v) const;
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(u);
  }
  float at(int u, int v) const { return inverse_depth_[index(u, v)]; }

  DistortedCamera camera_;
  Mask mask_;
  ObjectWindow window_ = {};
  std::vector<float> inverse_depth_ = {};  // 1/metres, row by row; 0 is no reading
};

/// Readings above the plane z = 0 and near the axis x = y = 0 of a pose's frame.
/// @param platform_from_sensor  metres; or the object's frame, whose plane and axis are the same
ObjectView::Mask make_mask(const Eigen::Isometry3d& platform_from_sensor);

}  // namespace octurn
