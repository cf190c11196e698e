#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "depth/object_window.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A point of a surface, with its normal towards the sensor; metres, frame of the turn.
struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// One stop of a turn: the rectangle of its depth image that shows the object, and for the whole
/// image the depth up to which rays were free. Points are in the turn's frame, the platform's at
/// angle 0.
class StopView {
 public:
  /// @param turn_from_sensor  optical frame to the turn's frame
  /// @param object            metres, the turn's frame: the object's readings lie inside
  /// @throws std::invalid_argument  if the image has another size than the intrinsics say
  StopView(const DepthFrame& frame, const Intrinsics& intrinsics,
           const Eigen::Isometry3d& turn_from_sensor, Box object);

  /// Where the sensor stood.
  const Eigen::Vector3d& eye() const { return eye_; }

  /// Pixels that are the object's.
  int pixels() const { return window_.pixels; }

  /// The reading nearest to where a point is seen: on the plane through its neighbours, with that
  /// plane's normal. On a curved surface such points lie behind it, in all turns alike.
  /// @return nothing if nothing was read there, near a depth edge, or at a grazing angle
  std::optional<SurfacePoint> look_up(const Eigen::Vector3d& point) const;

  /// The object's readings, of pixels `step` apart.
  std::vector<SurfacePoint> readings(int step) const;

  /// Whether the sensor saw something well behind a point, and nothing in front of that.
  bool saw_through(const Eigen::Vector3d& point) const;

 private:
  void keep_object(const DepthFrame& frame);
  void find_free_depths(const DepthFrame& frame);
  std::optional<SurfacePoint> read(int u, int v) const;
  double depth(int u, int v) const {
    return depth_[static_cast<std::size_t>(v) * static_cast<std::size_t>(window_.width) +
                  static_cast<std::size_t>(u)] *
           intrinsics_.depth_unit;
  }

  Intrinsics intrinsics_;
  Eigen::Isometry3d sensor_from_turn_;
  Eigen::Matrix3d turn_from_sensor_;
  Eigen::Vector3d eye_;
  Box object_;
  ObjectWindow window_ = {};
  std::vector<std::uint16_t> depth_ = {};  // of the rectangle, row by row, in depth units
  std::vector<std::uint16_t> free_ = {};   // of blocks of the image: the smallest; 0: unknown
};

}  // namespace octurn
