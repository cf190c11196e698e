#include "register/rigid_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "octurn/register.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double max_motion = 0.1;  // radians or metres
constexpr double lever = 0.05;      // metres

// Damping that keeps undetermined motions small, such as a vase's rotation about its axis. It is a
// share of the total weight; rotations are damped by their motion at the lever.
constexpr double damping = 1e-4;

constexpr double min_breadth = 0.003;  // metres, rms: the rotation about a line of points is free

}  // namespace

void RigidFit::add(const Vector3d& point, const Vector3d& normal, double distance,
                   double of_weight) {
  Vector6d row;
  row << (point - middle).cross(normal), normal;
  const Vector6d weighed = of_weight * row;
  // Only the lower triangle, in pairs of columns: whole columns would take 50 % more operations.
  normal_matrix.col(0) += row[0] * weighed;
  normal_matrix.col(1) += row[1] * weighed;
  normal_matrix.col(2).tail<4>() += row[2] * weighed.tail<4>();
  normal_matrix.col(3).tail<4>() += row[3] * weighed.tail<4>();
  normal_matrix.col(4).tail<2>() += row[4] * weighed.tail<2>();
  normal_matrix.col(5).tail<2>() += row[5] * weighed.tail<2>();
  right -= of_weight * distance * row;
  weight += of_weight;
  squares += of_weight * distance * distance;
  ++count;
}

void RigidFit::operator+=(const RigidFit& other) {
  normal_matrix += other.normal_matrix;
  right += other.right;
  weight += other.weight;
  squares += other.squares;
  count += other.count;
}

RigidFit::Matrix6d RigidFit::damped() const {
  Matrix6d matrix = normal_matrix.selfadjointView<Eigen::Lower>();
  matrix.diagonal().head<3>().array() += damping * lever * lever * weight;
  matrix.diagonal().tail<3>().array() += damping * weight;
  return matrix;
}

Eigen::Isometry3d RigidFit::motion() const {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (count == 0) {
    return motion;
  }
  Vector6d wanted = damped().ldlt().solve(right);
  if (!wanted.allFinite()) {
    return motion;
  }
  wanted *= std::min(1.0, max_motion / std::max(wanted.cwiseAbs().maxCoeff(), 1e-12));
  const Vector3d rotation = wanted.head<3>();
  const double angle = rotation.norm();
  if (angle > 0) {
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  motion.translation() = middle + wanted.tail<3>() - motion.linear() * middle;
  return motion;
}

RigidFit::Matrix6d RigidFit::covariance(double correlation) const {
  const double variance = weight > 0 ? squares / weight * correlation : 1;
  return damped().inverse() * variance;
}

double motion_length(const Eigen::Isometry3d& motion, const Vector3d& middle) {
  const Vector3d shift = motion * middle - middle;
  return shift.norm() + lever * Eigen::AngleAxisd(motion.linear()).angle();
}

std::optional<Eigen::Isometry3d> pose_from_pairs(std::span<const PointPair> pairs) {
  const auto count = static_cast<double>(std::max<std::size_t>(pairs.size(), 1));
  Vector3d object_middle = Vector3d::Zero();
  Vector3d platform_middle = Vector3d::Zero();
  for (const PointPair& pair : pairs) {
    object_middle += pair.object / count;
    platform_middle += pair.platform / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    covariance +=
        (pair.object - object_middle) * (pair.platform - platform_middle).transpose() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > min_breadth * min_breadth)) {
    return std::nullopt;
  }
  const Eigen::Matrix3d mirrored = svd.matrixU() * svd.matrixV().transpose();
  const Vector3d signs(1, 1, mirrored.determinant() < 0 ? -1 : 1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  pose.translation() = object_middle - pose.linear() * platform_middle;
  return pose;
}

}  // namespace octurn
