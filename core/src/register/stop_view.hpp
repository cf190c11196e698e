#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "depth/seen_pixels.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A point of a surface, with its normal towards the sensor; metres, frame of the turn.
struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// Tabulates the inverse depth of every possible reading, 1/m; 0 for no reading. A table saves
/// divisions, as each reading is used in 25 windows.
std::vector<double> to_inverse_depths(double depth_unit);

/// One stop of a turn: the rectangle of its depth image that shows the object. Points are in the
/// turn's frame, the platform's at angle 0.
class StopView {
 public:
  /// @param turn_from_sensor  optical frame to the turn's frame
  /// @param object            metres, the turn's frame: the object's readings lie inside
  /// @param inverse_depths    of the intrinsics' depth unit
  /// @throws std::invalid_argument  if the image has another size than the intrinsics say
  StopView(const DepthFrame& frame, const Intrinsics& intrinsics,
           const Eigen::Isometry3d& turn_from_sensor, Box object,
           std::shared_ptr<const std::vector<double>> inverse_depths);

  const Eigen::Isometry3d& sensor_from_turn() const { return sensor_from_turn_; }

  /// The sensor's position, metres, frame of the turn.
  const Eigen::Vector3d& eye() const { return eye_; }

  /// The number of pixels that show the object.
  int pixels() const { return window_.pixels; }

  /// Returns the surface at the pixel that `point` projects to: point and normal of the plane
  /// fitted around it. On a curved surface such points lie behind the surface, equally in all
  /// turns.
  /// @return nothing if there is no reading, near a depth edge, or at grazing incidence
  std::optional<SurfacePoint> look_up(const Eigen::Vector3d& point) const;

  /// The surface points of the object at every `step`-th pixel of every `step`-th row.
  std::vector<SurfacePoint> readings(int step) const;

 private:
  void keep_object(const DepthFrame& frame);
  std::optional<SurfacePoint> read(int u, int v) const;
  std::uint16_t depth(int u, int v) const {
    return depth_[static_cast<std::size_t>(v) * static_cast<std::size_t>(window_.width) +
                  static_cast<std::size_t>(u)];
  }

  Intrinsics intrinsics_;
  Eigen::Isometry3d sensor_from_turn_;
  Eigen::Matrix3d turn_from_sensor_;
  Eigen::Vector3d eye_;
  Box object_;
  ObjectWindow window_ = {};
  std::vector<std::uint16_t> depth_ = {};  // of the rectangle, row by row, in depth units
  std::shared_ptr<const std::vector<double>> inverse_depths_;
};

}  // namespace octurn
