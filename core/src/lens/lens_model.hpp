#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "octurn/lens.hpp"

namespace octurn {

/// fx, fy, cx, cy, k1, k2.
using LensNumbers = Eigen::Matrix<double, 6, 1>;

/// The unknowns: a lens, and the board's pose in each view. X of the board's frame counts columns,
/// and Y rows; lengths are in squares.
struct LensAndBoards {
  LensNumbers lens = LensNumbers::Zero();
  std::vector<Eigen::Isometry3d> camera_from_board = {};
};

/// The projection of a corner, and its Jacobian.
struct SeenCorner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_lens = Eigen::Matrix<double, 2, 6>::Zero();
  /// With respect to a small rotation of the board about the camera's axes through the board's
  /// origin, then to a shift along them.
  Eigen::Matrix<double, 2, 6> by_board = Eigen::Matrix<double, 2, 6>::Zero();
};

SeenCorner see(const LensNumbers& lens, const Eigen::Isometry3d& camera_from_board,
               const BoardCorner& corner);

/// An initial estimate of a lens and its boards: no distortion, the principal point in the
/// picture's centre, fx and fy in closed form from the views' homographies (Zhang 2000, section
/// 3.1).
LensAndBoards first_lens(const std::vector<BoardView>& views, int width, int height);

}  // namespace octurn
