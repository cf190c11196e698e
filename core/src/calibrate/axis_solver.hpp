#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"

namespace octurn {

/// The turning axis, as the stops agree about the object.
struct AxisSolution {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// Of the small motion (rotation about x and y, translation along x and y): radians, metres.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double last_step = 0;  ///< metres, that the last iteration moved the axis 5 cm above the platform

  double position_sigma() const;   ///< metres, of the axis 5 cm above the platform
  double direction_sigma() const;  ///< radians
};

/// Moves a pose's axis, and slides its origin along it to where it meets the plane.
/// @param pose    optical frame to platform frame
/// @param motion  rotation about x and y (radians), translation along x and y (metres), both small
Eigen::Isometry3d with_axis_moved(const Eigen::Isometry3d& pose, const PlatformPlane& plane,
                                  const Eigen::Vector4d& motion);

/// Moves a pose until the stops agree best: Gauss-Newton over the axis's direction and place, the
/// distances weighted as Cauchy distributed. Height and turn about the axis stay: the plane tells
/// the one, and nothing the other.
///
/// With the readings of the platform frame at stop i, X = Rz(-a_i) (p + w x p + t): a residual
/// N . (X_i - X_j) changes by (p_i x M - p_j x n) . w + (M - n) . t, where M and n are N in the
/// platform frame at the one and the other stop.
///
/// @param start           optical frame to platform frame, in which the plane is nearly z = 0
/// @param direction_sigma radians: how far the axis may be from the plane's normal
/// @return nothing if too little of the object was seen twice
std::optional<AxisSolution> solve_axis(const TurnViews& turn, const PlatformPlane& plane,
                                       const Eigen::Isometry3d& start, double direction_sigma,
                                       int threads);

}  // namespace octurn
