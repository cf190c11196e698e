#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr double rotation_slack = 1e-4;  // of R R^T - 1: files hold rounded decimals

}  // namespace

bool is_rigid(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const double defect = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  return defect <= rotation_slack && rotation.determinant() > 0 &&
         matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
}

Eigen::Isometry3d object_from_sensor(const Eigen::Isometry3d& platform_from_sensor, double angle) {
  return Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()) * platform_from_sensor;
}

}  // namespace octurn
