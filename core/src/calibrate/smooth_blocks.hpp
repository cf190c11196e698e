#pragma once

#include <vector>

namespace octurn {

/// Values on a grid, some of them unknown.
struct BlockValues {
  int columns = 0;
  int rows = 0;
  std::vector<double> values = {};   ///< columns x rows, row by row
  std::vector<double> weights = {};  ///< the same: 1 where the value is known, else 0
};

/// Smooths known values with a Gaussian window, then adds the smoothed residuals ("twicing", Tukey
/// 1977): long waves keep their amplitude, short ones vanish. Unknown values have no weight; far
/// from known ones they are filled by diffusion (Laplace's equation).
///
/// @param sigma  of the window, cells
/// @return columns x rows values; 0 if none is known
std::vector<double> smooth_blocks(const BlockValues& blocks, double sigma);

}  // namespace octurn
