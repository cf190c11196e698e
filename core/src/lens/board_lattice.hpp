#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lens/board_edges.hpp"

namespace octurn {

/// A corner's place on a board.
struct LatticePlace {
  std::size_t corner = 0;
  Eigen::Vector2i square = Eigen::Vector2i::Zero();  ///< column and row, from any corner
};

/// The largest piece of board that edges tell: corners that hang together, each at a place of its
/// own. One that its neighbours on both sides do not have about in their middle is left out.
/// @param corners  pixels
std::vector<LatticePlace> grow_lattice(std::span<const Eigen::Vector2d> corners,
                                       std::span<const CornerEdges> edges);

}  // namespace octurn
