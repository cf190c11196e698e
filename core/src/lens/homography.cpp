#include "lens/homography.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

namespace octurn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d to_place(const BoardCorner& corner) { return {corner.column, corner.row}; }

/// The transform that moves the points' mean to the origin, and scales their mean distance from it
/// to the square root of 2.
Matrix3d normalisation(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& point : points) {
    mean += point / static_cast<double>(points.size());
  }
  double distance = 0;
  for (const Vector2d& point : points) {
    distance += (point - mean).norm() / static_cast<double>(points.size());
  }
  const double scale = std::numbers::sqrt2 / distance;
  Matrix3d matrix = Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() *= scale;
  matrix.topRightCorner<2, 1>() = -scale * mean;
  return matrix;
}

}  // namespace

Matrix3d board_homography(const BoardView& view) {
  std::vector<Vector2d> places;
  std::vector<Vector2d> pixels;
  for (const BoardCorner& corner : view) {
    places.push_back(to_place(corner));
    pixels.push_back(corner.pixel);
  }
  const Matrix3d of_places = normalisation(places);
  const Matrix3d of_pixels = normalisation(pixels);
  using Row = Eigen::Matrix<double, 1, 9>;
  Eigen::Matrix<double, 9, 9> squares = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Vector3d from = of_places * places[i].homogeneous();
    const Vector3d to = of_pixels * pixels[i].homogeneous();
    Row first = Row::Zero();
    Row second = Row::Zero();
    first.segment<3>(0) = from.transpose();
    first.segment<3>(6) = -to.x() * from.transpose();
    second.segment<3>(3) = from.transpose();
    second.segment<3>(6) = -to.y() * from.transpose();
    squares += first.transpose() * first + second.transpose() * second;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(squares);
  const Eigen::Matrix<double, 9, 1> least = solver.eigenvectors().col(0);
  Matrix3d normalised;
  normalised << least.segment<3>(0).transpose(), least.segment<3>(3).transpose(),
      least.segment<3>(6).transpose();
  return of_pixels.inverse() * normalised * of_places;
}

}  // namespace octurn
