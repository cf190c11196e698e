#include <Eigen/SVD>
#include <algorithm>

#include "octurn/register.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double min_breadth = 0.003;  // metres, rms: the rotation about a line of points is free

}  // namespace

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
