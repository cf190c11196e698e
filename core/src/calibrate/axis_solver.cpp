#include "calibrate/axis_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calibrate/normal_equations.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr int max_iterations = 14;
constexpr double max_motion = 0.03;      // radians or metres in one iteration
constexpr double near_step = 1e-4;       // metres: the end is near
constexpr double settled_step = 5e-6;    // metres
constexpr double position_lever = 0.05;  // metres above the platform, where positions are judged

// Coarse to fine: from a start that is 20 mm off, residuals up to 20 mm pull the axis near. Then
// only residuals that noise explains count.
constexpr std::array axis_schedule = {
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.004},
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.004},
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.004},
    ResidualLimits{.max_distance = 0.01, .cauchy_scale = 0.003},
    ResidualLimits{.max_distance = 0.01, .cauchy_scale = 0.003},
    ResidualLimits{.max_distance = 0.005, .cauchy_scale = 0.002},
};

constexpr std::size_t last_stage = axis_schedule.size() - 1;

double step_length(const Vector4d& motion) {
  return std::hypot(motion[2] + position_lever * motion[1], motion[3] - position_lever * motion[0]);
}

double largest_eigenvalue(const Eigen::Matrix2d& symmetric) {
  return symmetric.trace() / 2 +
         std::hypot((symmetric(0, 0) - symmetric(1, 1)) / 2, symmetric(0, 1));
}

}  // namespace

Eigen::Isometry3d with_axis_moved(const Eigen::Isometry3d& pose, const PlatformPlane& plane,
                                  const Vector4d& motion) {
  const Vector3d rotation(motion[0], motion[1], 0);
  const double angle = rotation.norm();
  Eigen::Isometry3d change = Eigen::Isometry3d::Identity();
  if (angle > 0) {
    change.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  change.translation() = Vector3d(motion[2], motion[3], 0);
  Eigen::Isometry3d moved = change * pose;
  const Vector3d normal = moved.linear() * plane.normal;
  const double height = normal.dot(moved * (plane.normal * plane.offset)) / normal.z();
  moved.translation().z() -= height;
  return moved;
}

double AxisSolution::position_sigma() const {
  Eigen::Matrix<double, 2, 4> at_lever = Eigen::Matrix<double, 2, 4>::Zero();
  at_lever << 0, position_lever, 1, 0, -position_lever, 0, 0, 1;
  const Eigen::Matrix2d spread = at_lever * covariance * at_lever.transpose();
  return std::sqrt(largest_eigenvalue(spread));
}

double AxisSolution::direction_sigma() const {
  const Eigen::Matrix2d spread = covariance.topLeftCorner<2, 2>();
  return std::sqrt(largest_eigenvalue(spread));
}

std::optional<AxisSolution> solve_axis(const TurnViews& turn, const PlatformPlane& plane,
                                       const Eigen::Isometry3d& start, double direction_sigma,
                                       int threads) {
  AxisSolution solution{.platform_from_sensor = start};
  std::size_t stage = 0;
  for (int i = 0; i < max_iterations; ++i) {
    const ResidualLimits& limits = axis_schedule[stage];
    const NormalEquations sums =
        normal_equations<4>(turn, solution.platform_from_sensor, limits, threads, axis_row);
    if (sums.count < min_residuals) {
      return std::nullopt;
    }
    const double variance = sums.squares / sums.weight * turn.correlation;
    NormalEquations scaled = sums.scaled(variance);
    scaled.add_plane(solution.platform_from_sensor.linear() * plane.normal,
                     1 / (direction_sigma * direction_sigma));
    solution.covariance = scaled.matrix.inverse();
    const Vector4d wanted = scaled.matrix.ldlt().solve(scaled.right);
    if (!wanted.allFinite()) {
      return std::nullopt;
    }
    const double largest = wanted.cwiseAbs().maxCoeff();
    const Vector4d motion =
        largest > max_motion ? Vector4d(wanted * (max_motion / largest)) : wanted;
    solution.platform_from_sensor = with_axis_moved(solution.platform_from_sensor, plane, motion);
    solution.last_step = step_length(motion);
    if (stage == last_stage && solution.last_step < settled_step) {
      break;
    }
    stage = solution.last_step < near_step ? last_stage : std::min(stage + 1, last_stage);
  }
  return solution;
}

}  // namespace octurn
