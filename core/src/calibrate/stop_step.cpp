#include "calibrate/stop_step.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "calibrate/for_each_stop.hpp"
#include "octurn/units.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr ResidualLimits step_limits{.max_distance = 0.02, .cauchy_scale = 0.004};
constexpr double shift_sigmas = 5;
constexpr double min_move_explained = 0.05;  // of the residuals' sum of squares
constexpr double better = 1.5;  // times the share of a turn, which has one unknown less

/// Unknowns of each stop: a shift along x and y and a turn about z, in the object's frame.
constexpr Index unknowns = 3;

/// The residuals of a pair of stops in the normal equations.
struct PairMotionSums {
  std::size_t to = 0;
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
};

struct StopMotionSums {
  std::vector<PairMotionSums> pairs = {};
  double weight = 0;
  double squares = 0;
  std::size_t count = 0;
};

StopMotionSums motion_sums(const TurnViews& turn, const Eigen::Isometry3d& pose, std::size_t stop) {
  StopMotionSums sums;
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  const Eigen::Matrix3d to_object =
      Eigen::AngleAxisd(-turn.angles[stop], Vector3d::UnitZ()).toRotationMatrix();
  for_each_residual(turn, pose, as_told, stop, step_limits, [&](const StopResidual& residual) {
    if (sums.pairs.empty() || sums.pairs.back().to != residual.to) {
      sums.pairs.push_back({.to = residual.to});
    }
    const Vector3d normal = to_object * residual.normal_from;
    const double turning = residual.normal_from.dot(Vector3d::UnitZ().cross(residual.point_from));
    Eigen::Matrix<double, 6, 1> row;
    row << normal.x(), normal.y(), turning, -normal.x(), -normal.y(),
        -residual.normal_to.dot(Vector3d::UnitZ().cross(residual.point_to));
    const double weight = step_limits.weight(residual.distance);
    sums.pairs.back().normal_matrix += weight * row * row.transpose();
    sums.pairs.back().right += weight * residual.distance * row;
    sums.weight += weight;
    sums.squares += weight * residual.distance * residual.distance;
    ++sums.count;
  });
  return sums;
}

struct MotionEquations {
  MatrixXd normal_matrix;
  VectorXd right;
  double weight = 0;
  double squares = 0;
  std::size_t count = 0;
};

MotionEquations motion_equations(const TurnViews& turn, const Eigen::Isometry3d& pose,
                                 int threads) {
  const std::size_t stops = turn.views.size();
  std::vector<StopMotionSums> of_stops(stops);
  for_each_stop(stops, threads,
                [&](std::size_t stop) { of_stops[stop] = motion_sums(turn, pose, stop); });
  const Index size = unknowns * static_cast<Index>(stops);
  MotionEquations all{.normal_matrix = MatrixXd::Zero(size, size), .right = VectorXd::Zero(size)};
  for (std::size_t stop = 0; stop < stops; ++stop) {
    const Index from = unknowns * static_cast<Index>(stop);
    for (const PairMotionSums& pair : of_stops[stop].pairs) {
      const Index to = unknowns * static_cast<Index>(pair.to);
      for (const auto& [row, first] : {std::pair{from, Index{0}}, std::pair{to, unknowns}}) {
        for (const auto& [column, second] : {std::pair{from, Index{0}}, std::pair{to, unknowns}}) {
          all.normal_matrix.block<unknowns, unknowns>(row, column) +=
              pair.normal_matrix.block<unknowns, unknowns>(first, second);
        }
        all.right.segment<unknowns>(row) += pair.right.segment<unknowns>(first);
      }
    }
    all.weight += of_stops[stop].weight;
    all.squares += of_stops[stop].squares;
    all.count += of_stops[stop].count;
  }
  return all;
}

/// The shifts of all stops that a shift of the axis along x and along y causes.
MatrixXd make_axis_columns(const std::vector<double>& angles) {
  MatrixXd columns = MatrixXd::Zero(unknowns * static_cast<Index>(angles.size()), 2);
  for (std::size_t stop = 0; stop < angles.size(); ++stop) {
    columns.block<2, 2>(unknowns * static_cast<Index>(stop), 0) =
        Eigen::Rotation2Dd(-angles[stop]).toRotationMatrix();
  }
  return columns;
}

/// A hypothesis, solved.
struct Solved {
  SymmetricSolution solution = {};  // empty: the data do not determine it
  double explained = 0;
};

Solved solve_hypothesis(const MotionEquations& all, const MatrixXd& columns) {
  const VectorXd right = columns.transpose() * all.right;
  auto solution = solve_symmetric(columns.transpose() * all.normal_matrix * columns, right);
  if (!solution) {
    return {};
  }
  const double explained = right.dot(solution->values);
  return {.solution = *std::move(solution), .explained = explained};
}

}  // namespace

std::optional<ObjectStep> solve_object_step(const TurnViews& turn,
                                            const Eigen::Isometry3d& platform_from_sensor,
                                            int threads) {
  const MotionEquations all = motion_equations(turn, platform_from_sensor, threads);
  if (all.count < min_residuals || !(all.squares > 0)) {
    return std::nullopt;
  }
  const MatrixXd axis = make_axis_columns(turn.angles);
  const double of_axis = solve_hypothesis(all, axis).explained;
  const double variance = all.squares / all.weight * turn.correlation;
  ObjectStep best;
  for (std::size_t stop = 1; stop < turn.angles.size(); ++stop) {
    MatrixXd moved = MatrixXd::Zero(axis.rows(), 4);
    MatrixXd turned = MatrixXd::Zero(axis.rows(), 3);
    moved.rightCols(2) = axis;
    turned.rightCols(2) = axis;
    for (Index row = unknowns * static_cast<Index>(stop); row < axis.rows(); row += unknowns) {
      moved(row, 0) = 1;
      moved(row + 1, 1) = 1;
      turned(row + 2, 0) = 1;
    }
    best.turn_explained = std::max(
        best.turn_explained, (solve_hypothesis(all, turned).explained - of_axis) / all.squares);
    const Solved solved = solve_hypothesis(all, moved);
    const double explained = (solved.explained - of_axis) / all.squares;
    if (explained > best.explained) {
      const auto& [values, inverse] = solved.solution;
      best.stop = stop;
      best.shift = values.head<2>();
      best.sigma = std::sqrt(variance * inverse.topLeftCorner<2, 2>().diagonal().maxCoeff());
      best.explained = explained;
    }
  }
  return best;
}

std::optional<CalibrationFinding> find_move(const ObjectStep& step) {
  const double size = step.shift.norm();
  if (size < min_move_shift || size < shift_sigmas * step.sigma ||
      step.explained < min_move_explained || step.explained < better * step.turn_explained) {
    return std::nullopt;
  }
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "between stops %zu and %zu the object moved by %.1f mm",
                step.stop - 1, step.stop, mm_from_metres(size));
  return CalibrationFinding{.code = "moved",
                            .detail = text.data(),
                            .hint = "Fix the object to the platform, or turn more slowly.",
                            .stop = {},
                            .angle = {},
                            .parameters = {{"from_stop", static_cast<double>(step.stop - 1)},
                                           {"to_stop", static_cast<double>(step.stop)},
                                           {"shift_mm", mm_from_metres(size)}}};
}

}  // namespace octurn
