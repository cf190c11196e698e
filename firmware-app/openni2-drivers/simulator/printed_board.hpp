#pragma once

#include <Eigen/Geometry>

namespace octurn {

// The board that Octurn prints: 12 by 17 squares of 15 mm with a white margin, in a grey room. Its
// frame has its origin at the corner of a square; X counts columns, Y rows, lengths are in squares.

inline constexpr double board_square = 0.015;  ///< metres
inline constexpr int board_columns = 17;
inline constexpr int board_rows = 12;
inline constexpr double board_margin = 0.6;  ///< width of the white border, squares

/// How somebody holds the board before a camera.
struct BoardHold {
  double across = 0.5;  ///< place of its centre in the picture, as fractions
  double down = 0.5;
  double distance = 0.33;  ///< metres
  double about_x = 0;      ///< radians, about the camera's axes
  double about_y = 0;
  double about_z = 0;
};

/// The pose of a board that is held so. @param middle  the ray (x, y, 1) of its centre
Eigen::Isometry3d camera_from_board(const BoardHold& hold, const Eigen::Vector2d& middle);

/// Where a ray (x, y, 1) meets the board's plane, squares.
Eigen::Vector2d intersect_board(const Eigen::Isometry3d& board_from_camera,
                                const Eigen::Vector2d& ray);

/// Whether a place of the board's plane is on its paper.
bool is_on_board(const Eigen::Vector2d& place);

/// The grey level that is seen along a ray (x, y, 1), as lens and pixel blur the squares' borders.
/// @param place  where the ray meets the board's plane
/// @param pixel  width and height of a pixel at the distance 1
double board_light(const Eigen::Isometry3d& board_from_camera, const Eigen::Vector2d& ray,
                   const Eigen::Vector2d& place, const Eigen::Vector2d& pixel);

}  // namespace octurn
