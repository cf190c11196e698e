#pragma once

#include <vector>

#include "laser/find_line.hpp"

namespace octurn {

/// Links the samples of neighbouring rows to pieces of line, drops short pieces and the ends of the
/// others, and smooths each sample's column by a quadratic fit along its piece.
///
/// @param samples  row by row, in each from left to right; not linked yet
/// @return those that are left, in the same order
std::vector<LineSample> smoothed_pieces(std::vector<LineSample> samples, const LineScale& scale);

}  // namespace octurn
