#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lens/board_edges.hpp"
#include "octurn/lens.hpp"

namespace octurn {

/// A corner's position on a board.
struct LatticePlace {
  std::size_t corner = 0;
  Eigen::Vector2i square = Eigen::Vector2i::Zero();  ///< column and row, from an arbitrary origin
};

/// Returns the largest connected lattice of corners, each at a position of its own. A corner that
/// does not lie near the midpoint of its neighbours is left out.
/// @param corners  pixels
std::vector<LatticePlace> grow_lattice(std::span<const Eigen::Vector2d> corners,
                                       std::span<const CornerEdges> edges);

inline constexpr std::size_t min_board_corners = 20;  ///< fewer are no board

/// Finds the corners of a chessboard in a smoothed image, and grows their lattice.
BoardView find_lattice(const GreyImage& image);

}  // namespace octurn
