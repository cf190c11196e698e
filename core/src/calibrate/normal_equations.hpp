#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrate/for_each_stop.hpp"
#include "calibrate/stop_residuals.hpp"

namespace octurn {

/// Weighted least squares over residuals.
template <int unknowns>
struct NormalEquations {
  using Vector = Eigen::Matrix<double, unknowns, 1>;

  Eigen::Matrix<double, unknowns, unknowns> matrix =
      Eigen::Matrix<double, unknowns, unknowns>::Zero();
  Vector right = Vector::Zero();
  double weight = 0;
  double squares = 0;
  std::size_t count = 0;

  /// @param row  derivatives of the residual by the unknowns
  void add(const Vector& row, double residual, double its_weight) {
    matrix += its_weight * row * row.transpose();
    right -= its_weight * residual * row;
    weight += its_weight;
    squares += its_weight * residual * residual;
    ++count;
  }

  void operator+=(const NormalEquations& other) {
    matrix += other.matrix;
    right += other.right;
    weight += other.weight;
    squares += other.squares;
    count += other.count;
  }

  /// The equations divided by the residuals' variance, so that measurements can be added by their
  /// sigma.
  NormalEquations scaled(double variance) const {
    return {.matrix = matrix / variance, .right = right / variance};
  }

  /// Adds the platform's plane as a measurement of the axis's direction, whose rotation about x and
  /// y are the first unknowns: the normal's x and y should be 0.
  /// @param information  1 / sigma^2, radians
  void add_plane(const Eigen::Vector3d& normal, double information) {
    // A small rotation w takes a normal near z to n + (w_y, -w_x, 0).
    matrix(1, 1) += information;
    right(1) -= information * normal.x();
    matrix(0, 0) += information;
    right(0) += information * normal.y();
  }
};

/// Derivatives of a residual by the axis: rotation about x and y, translation along x and y.
inline Eigen::Vector4d axis_row(const StopResidual& residual) {
  const Eigen::Vector3d turning =
      residual.point_from.cross(residual.normal_from) - residual.point_to.cross(residual.normal_to);
  const Eigen::Vector3d moving = residual.normal_from - residual.normal_to;
  return {turning.x(), turning.y(), moving.x(), moving.y()};
}

/// Sums over all stops, added in the order of the stops, so that threads change no bit.
/// @param row_of  gives a residual's row
template <int unknowns, typename RowOf>
NormalEquations<unknowns> normal_equations(const TurnViews& turn, const Eigen::Isometry3d& pose,
                                           const ResidualLimits& limits, int threads,
                                           const RowOf& row_of) {
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  std::vector<NormalEquations<unknowns>> of_stops(turn.views.size());
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    for_each_residual(turn, pose, as_told, stop, limits, [&](const StopResidual& residual) {
      of_stops[stop].add(row_of(residual), residual.distance, limits.weight(residual.distance));
    });
  });
  NormalEquations<unknowns> all;
  for (const NormalEquations<unknowns>& equations : of_stops) {
    all += equations;
  }
  return all;
}

}  // namespace octurn
