#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"

namespace octurn {

/// Sigma of the plane as a loose prior of the axis's direction: the object decides.
inline constexpr double loose_direction_deg = 0.2;

/// The turning axis as solved from the residuals between stops.
struct AxisSolution {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// Of the small motion (rotation about x and y, translation along x and y): radians, metres.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  /// Metres: change of the axis, 5 cm above the platform, in the last iteration.
  double last_step = 0;

  double position_sigma() const;   ///< metres, of the axis 5 cm above the platform
  double direction_sigma() const;  ///< radians
};

/// Solves the axis by Gauss-Newton over its direction and position, with Cauchy weights on the
/// residuals. The height, which the plane determines, and the rotation about the axis, which
/// nothing determines, stay.
///
/// For a reading p in the platform frame at stop i, X = Rz(-a_i) (p + w x p + t). A residual
/// N . (X_i - X_j) changes by (p_i x M - p_j x n) . w + (M - n) . t, where M and n are N in the
/// platform frame at i and at j.
///
/// @param start           optical frame to platform frame, in which the plane is nearly z = 0
/// @param direction_sigma radians: of the plane's normal as a prior of the axis
/// @return nothing if too few readings of the object have a partner
std::optional<AxisSolution> solve_axis(const TurnViews& turn, const PlatformPlane& plane,
                                       const Eigen::Isometry3d& start, double direction_sigma,
                                       int threads);

/// Initial axis for `solve_axis`: the configured one, or the one about which the object's outline
/// turns, whichever has the smaller residuals. From a configured axis 2 cm off, the sides of a flat
/// object overlap so little that the solver would not converge.
///
/// Averaged over a whole turn, the middle between the outline's left and right ends is the axis,
/// and its nearest end is as far in front of the axis as these are beside it: both are averages of
/// the support function of its convex hull.
///
/// @param levelled  optical frame to platform frame as configured, with the platform's surface at z
/// = 0
Eigen::Isometry3d find_axis_start(const TurnViews& turn, const Eigen::Isometry3d& levelled,
                                  int threads);

}  // namespace octurn
