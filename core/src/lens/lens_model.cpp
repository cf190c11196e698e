#include "lens/lens_model.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "lens/homography.hpp"

namespace octurn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double usual_focal = 1.0;  // of the picture's width, if the views do not determine it

/// Solves the squares of fx and fy for which the first two columns of each homography become
/// perpendicular and equally long, by least squares.
/// @param homographies  board to pixels relative to the principal point
Vector2d focal_squares(const std::vector<Matrix3d>& homographies) {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  const auto add = [&](const Vector2d& row, double value) {
    matrix += row * row.transpose();
    right += row * value;
  };
  for (const Matrix3d& given : homographies) {
    const Matrix3d h = given / given.leftCols<2>().norm();
    add({h(0, 0) * h(0, 1), h(1, 0) * h(1, 1)}, -h(2, 0) * h(2, 1));
    add({h(0, 0) * h(0, 0) - h(0, 1) * h(0, 1), h(1, 0) * h(1, 0) - h(1, 1) * h(1, 1)},
        h(2, 1) * h(2, 1) - h(2, 0) * h(2, 0));
  }
  const Vector2d inverse = matrix.fullPivLu().solve(right);
  return inverse.cwiseInverse();
}

Eigen::Isometry3d board_pose(const Matrix3d& homography, const LensNumbers& lens) {
  Matrix3d camera;
  camera << lens[0], 0, lens[2], 0, lens[1], lens[3], 0, 0, 1;
  Matrix3d columns = camera.inverse() * homography;
  columns /= (columns.col(0).norm() + columns.col(1).norm()) / 2;
  if (columns(2, 2) < 0) {
    columns = -columns;  // the board lies in front of the camera
  }
  Matrix3d axes = columns;
  axes.col(2) = columns.col(0).cross(columns.col(1));
  const Eigen::JacobiSVD<Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = columns.col(2);
  return pose;
}

}  // namespace

BoardPlace place_board(const BoardView& view, const Intrinsics& lens) {
  BoardPlace place;
  for (const BoardCorner& corner : view) {
    place.middle += corner.pixel / static_cast<double>(view.size());
  }
  LensNumbers numbers;
  numbers << lens.fx, lens.fy, lens.cx, lens.cy, 0, 0;
  const Eigen::Isometry3d pose = board_pose(board_homography(view), numbers);
  place.normal = pose.linear().col(2);
  const Vector3d ray((place.middle.x() - lens.cx) / lens.fx, (place.middle.y() - lens.cy) / lens.fy,
                     1);
  // The depth at which that ray meets the board, in squares.
  const double depth = place.normal.dot(pose.translation()) / place.normal.dot(ray);
  place.square = lens.fx / depth;
  return place;
}

SeenCorner see(const LensNumbers& lens, const Eigen::Isometry3d& camera_from_board,
               const BoardCorner& corner) {
  const double fx = lens[0];
  const double fy = lens[1];
  const double k1 = lens[4];
  const double k2 = lens[5];
  const Vector3d turned = camera_from_board.linear() * Vector3d(corner.column, corner.row, 0);
  const Vector3d point = turned + camera_from_board.translation();
  const double x = point.x() / point.z();
  const double y = point.y() / point.z();
  const double square = x * x + y * y;
  const double factor = 1 + square * (k1 + square * k2);
  SeenCorner seen;
  seen.pixel = Vector2d(fx * x * factor + lens[2], fy * y * factor + lens[3]);
  seen.by_lens << x * factor, 0, 1, 0, fx * x * square, fx * x * square * square,  //
      0, y * factor, 0, 1, fy * y * square, fy * y * square * square;
  const double slope = 2 * (k1 + 2 * k2 * square);  // d factor / dx is x times this
  Eigen::Matrix2d by_ray;
  by_ray << fx * (factor + x * x * slope), fx * x * y * slope,  //
      fy * x * y * slope, fy * (factor + y * y * slope);
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << 1, 0, -x, 0, 1, -y;
  by_point = by_ray * by_point / point.z();
  Matrix3d turning;  // d point / dw for a small rotation w: w x turned
  turning << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(), 0;
  seen.by_board << by_point * turning, by_point;
  return seen;
}

LensAndBoards first_lens(const std::vector<BoardView>& views, int width, int height) {
  const Vector2d middle((width - 1) / 2.0, (height - 1) / 2.0);
  Matrix3d from_middle = Matrix3d::Identity();
  from_middle.topRightCorner<2, 1>() = -middle;
  std::vector<Matrix3d> homographies;
  std::vector<Matrix3d> centred;
  for (const BoardView& view : views) {
    homographies.push_back(board_homography(view));
    centred.emplace_back(from_middle * homographies.back());
  }
  const Vector2d squares = focal_squares(centred);
  const double longest = 10.0 * width;
  const bool is_determined = squares.allFinite() && squares.minCoeff() > 0.01 * width * width &&
                             squares.maxCoeff() < longest * longest;
  const Vector2d focal =
      is_determined ? Vector2d(squares.cwiseSqrt()) : Vector2d::Constant(usual_focal * width);
  LensAndBoards first;
  first.lens << focal.x(), focal.y(), middle.x(), middle.y(), 0, 0;
  for (const Matrix3d& homography : homographies) {
    first.camera_from_board.push_back(board_pose(homography, first.lens));
  }
  return first;
}

}  // namespace octurn
