#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lens/board_edges.hpp"

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

}  // namespace octurn
