#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "parallel/thread_team.hpp"
#include "voxel/index3.hpp"

namespace octurn {

/// A dense grid of values, of which some are known; index x + size.x (y + size.y z).
struct PartialGrid {
  Index3 size = {};
  std::vector<float> values = {};
  std::vector<char> known = {};  ///< 1 where the value is given

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(x);
  }
};

/// Fills the unknown values by Laplace's equation: each becomes nearly the mean of its six
/// neighbours. The boundary condition is Neumann's: beyond the grid values repeat. Known values
/// stay.
///
/// Cascadic multigrid (Bornemann and Deuflhard 1996): each coarser grid, solved first, gives the
/// next finer one its first guess, which ten symmetric Gauss-Seidel sweeps smooth. A coarse value
/// is known if any of its eight finer ones is, and is their minimum, so that a thin shell of inside
/// (negative) values stays closed.
///
/// Deterministic for any number of threads, O(values). If no value is known, none changes.
/// @throws Stopped  between two layers
PartialGrid laplace_fill(PartialGrid grid, const std::stop_token& stop = {},
                         ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
