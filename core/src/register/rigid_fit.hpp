#pragma once

#include <Eigen/Geometry>
#include <cstddef>

namespace octurn {

/// Normal equations of a small motion, a rotation about a middle and a shift: distances along
/// normals, n . (p + w x (p - middle) + t) = 0, by weighted least squares.
struct RigidFit {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  /// Of rotation and shift: radians, metres. Its lower triangle alone.
  Matrix6d normal_matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double weight = 0;
  double squares = 0;  ///< metres^2, weighted
  std::size_t count = 0;

  /// @param distance  metres, that the point lies above the surface along the normal
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double distance,
           double of_weight);

  void operator+=(const RigidFit& other);

  /// The motion that the equations ask for, no longer than 0.1 radians or metres. What they leave
  /// open stays.
  Eigen::Isometry3d motion() const;

  /// Covariance of rotation and shift.
  /// @param correlation  residuals for each that is independent
  Matrix6d covariance(double correlation) const;

 private:
  Matrix6d damped() const;
};

/// How far a motion takes a point 5 cm from the middle, metres.
double motion_length(const Eigen::Isometry3d& motion, const Eigen::Vector3d& middle);

/// Weight of a distance that is Cauchy distributed.
inline double cauchy_weight(double distance, double scale) {
  const double ratio = distance / scale;
  return 1 / (1 + ratio * ratio);
}

}  // namespace octurn
