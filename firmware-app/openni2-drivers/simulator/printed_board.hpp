#pragma once

#include <Eigen/Geometry>

namespace octurn {

// The board that Octurn prints: 12 by 17 squares of 15 mm with a white margin, in a grey room. Its
// frame has its origin at the corner of a square; X counts columns, Y rows, lengths are in squares.

inline constexpr double board_square = 0.015;  ///< metres
inline constexpr int board_columns = 17;
inline constexpr int board_rows = 12;
inline constexpr double board_margin = 0.6;  ///< width of the white border, squares

/// Where a ray (x, y, 1) meets the board's plane, squares.
Eigen::Vector2d intersect_board(const Eigen::Isometry3d& board_from_camera,
                                const Eigen::Vector2d& ray);

/// Whether a place of the board's plane is on its paper.
bool is_on_board(const Eigen::Vector2d& place);

/// The grey level that is seen at a place of the board's plane.
/// @param width  of the border between squares, as lens and pixel blur it, squares
double board_light(const Eigen::Vector2d& place, const Eigen::Vector2d& width);

}  // namespace octurn
