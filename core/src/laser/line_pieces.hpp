#pragma once

#include <vector>

#include "laser/find_line.hpp"

namespace octurn {

/// Links the samples of neighbouring rows to pieces of line, drops short pieces and the ends of the
/// others, and smooths each sample's column by a quadratic fit along its piece.
///
/// @param samples  sorted by row, then column; not linked yet
/// @return the remaining samples, in the same order
std::vector<LineSample> smoothed_pieces(std::vector<LineSample> samples, const LineScale& scale);

}  // namespace octurn
