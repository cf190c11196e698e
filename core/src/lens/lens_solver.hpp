#pragma once

#include <vector>

#include "lens/lens_model.hpp"

namespace octurn {

/// A lens and its boards as they fit the views best.
struct LensFit {
  LensAndBoards found = {};
  LensNumbers sigma = LensNumbers::Zero();  ///< as the residuals tell
  double rms = 0;                           ///< pixels, of corners from where they should be
};

/// Least squares of the corners' distances in pixels by Levenberg and Marquardt's method. The
/// boards' poses are eliminated from each step's equations by Schur's complement.
LensFit fit_lens(const std::vector<BoardView>& views, LensAndBoards first);

/// Removes corners that lie five times as far off as most, and more than half a pixel.
void drop_outliers(std::vector<BoardView>& views, const LensAndBoards& found);

}  // namespace octurn
