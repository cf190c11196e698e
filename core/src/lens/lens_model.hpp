#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "octurn/lens.hpp"

namespace octurn {

/// fx, fy, cx, cy, k1, k2.
using LensNumbers = Eigen::Matrix<double, 6, 1>;

/// A lens and where a board lay in each view: what is solved. A board's frame has its X along
/// columns and its Y along rows; lengths are in squares.
struct LensAndBoards {
  LensNumbers lens = LensNumbers::Zero();
  std::vector<Eigen::Isometry3d> camera_from_board = {};
};

/// Where the lens shows a point, and how that changes.
struct SeenCorner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_lens = Eigen::Matrix<double, 2, 6>::Zero();
  /// With a small rotation of the board about the camera's axes, at the board's origin, and with a
  /// shift along them.
  Eigen::Matrix<double, 2, 6> by_board = Eigen::Matrix<double, 2, 6>::Zero();
};

SeenCorner see(const LensNumbers& lens, const Eigen::Isometry3d& camera_from_board,
               const BoardCorner& corner);

/// A first idea of a lens and its boards: without distortion, the principal point in the picture's
/// middle, fx and fy in closed form of the views' homographies (Zhang 2000, section 3.1).
LensAndBoards first_lens(const std::vector<BoardView>& views, int width, int height);

}  // namespace octurn
