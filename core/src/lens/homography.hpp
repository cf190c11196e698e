#pragma once

#include <Eigen/Core>

#include "octurn/lens.hpp"

namespace octurn {

/// The homography from a board's positions (column, row, 1) to pixels, by the direct linear
/// transformation on normalised points (Hartley and Zisserman 2004, section 4.4).
/// @param view  at least four corners, not all on a line
Eigen::Matrix3d board_homography(const BoardView& view);

}  // namespace octurn
