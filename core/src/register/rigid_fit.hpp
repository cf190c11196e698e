#pragma once

#include <Eigen/Geometry>
#include <cstddef>

namespace octurn {

/// Normal equations of a small rigid motion by weighted point-to-plane least squares, with the
/// unknowns rotation w about `middle` and shift t: d + n . (w x (p - middle) + t) = 0 for each
/// point
/// p at distance d from a plane of normal n.
struct RigidFit {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  /// Rotation (radians), then shift (metres). Only the lower triangle is filled.
  Matrix6d normal_matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double weight = 0;
  double squares = 0;  ///< metres^2, weighted
  std::size_t count = 0;

  /// @param distance  metres, of the point from the surface, positive along the normal
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double distance,
           double of_weight);

  void operator+=(const RigidFit& other);

  /// The solution, scaled so that no unknown exceeds 0.1 radians or metres. Damping keeps
  /// undetermined unknowns near 0.
  Eigen::Isometry3d motion() const;

  /// Covariance of rotation and shift.
  /// @param correlation  number of residuals per independent residual
  Matrix6d covariance(double correlation) const;

 private:
  Matrix6d damped() const;
};

/// Upper bound of the distance that a motion moves points up to 5 cm from `middle`, metres.
double motion_length(const Eigen::Isometry3d& motion, const Eigen::Vector3d& middle);

}  // namespace octurn
