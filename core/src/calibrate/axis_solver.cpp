#include "calibrate/axis_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "calibrate/for_each_stop.hpp"
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

/// Moves a pose's axis, and its origin to the point where the axis meets the plane.
/// @param pose    optical frame to platform frame
/// @param motion  rotation about x and y (radians), translation along x and y (metres), both small
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

}  // namespace

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

namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;

/// Ends of an outline, metres.
struct Outline {
  double left = std::numeric_limits<double>::max();
  double right = std::numeric_limits<double>::lowest();
  double near = std::numeric_limits<double>::max();
};

/// Agreement of the stops with a pose: the sum of the residuals' weights. A reading without a
/// surface near adds none.
double agreement(const TurnViews& turn, const Isometry3d& pose, int threads) {
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  std::vector<double> of_stops(turn.views.size());
  constexpr ResidualLimits limits;
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    for_each_residual(turn, pose, as_told, stop, limits, [&](const StopResidual& residual) {
      of_stops[stop] += limits.weight(residual.distance);
    });
  });
  return std::accumulate(of_stops.begin(), of_stops.end(), 0.0);
}

}  // namespace

Isometry3d find_axis_start(const TurnViews& turn, const Isometry3d& levelled, int threads) {
  const Vector2d away = -Vector2d(levelled.translation().head<2>()).normalized();
  const Vector2d aside(away.y(), -away.x());
  double beside = 0;
  double before = 0;
  double stops = 0;
  for (const std::vector<SurfaceReading>& readings : turn.readings) {
    Outline outline;
    for (const SurfaceReading& reading : readings) {
      const Vector2d point = (levelled * reading.point).head<2>();
      outline.left = std::min(outline.left, aside.dot(point));
      outline.right = std::max(outline.right, aside.dot(point));
      outline.near = std::min(outline.near, away.dot(point));
    }
    if (!readings.empty()) {
      beside += (outline.left + outline.right) / 2;
      before += outline.near + (outline.right - outline.left) / 2;
      ++stops;
    }
  }
  if (!(stops > 0)) {
    return levelled;
  }
  const Vector2d middle = beside / stops * aside + before / stops * away;
  const Isometry3d seen = Eigen::Translation3d(-middle.x(), -middle.y(), 0) * levelled;
  return agreement(turn, seen, threads) > agreement(turn, levelled, threads) ? seen : levelled;
}

}  // namespace octurn
