#pragma once

#include <vector>

#include "lens/lens_model.hpp"

namespace octurn {

/// The lens and the boards that fit the views best.
struct LensFit {
  LensAndBoards found = {};
  LensNumbers sigma = LensNumbers::Zero();  ///< standard deviations, from the residuals
  double rms = 0;                           ///< pixels, of the reprojection errors
};

/// Minimises the squared reprojection errors by Levenberg-Marquardt. The boards' poses are
/// eliminated from each step's equations by the Schur complement.
LensFit fit_lens(const std::vector<BoardView>& views, LensAndBoards first, PixelShape shape);

/// Removes corners whose reprojection error exceeds five times the median, and half a pixel.
void drop_outliers(std::vector<BoardView>& views, const LensAndBoards& found);

}  // namespace octurn
