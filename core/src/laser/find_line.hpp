#pragma once

#include <cstdint>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// Where a laser's line crosses one row of a picture.
struct LineSample {
  float u = 0;             ///< column, pixels; a fraction of one
  float light = 0;         ///< grey levels, the sum over the line's width
  int row = 0;             ///< of the picture
  std::int32_t next = -1;  ///< index of the sample that continues the line in the next row, or -1
};

/// Lengths along a picture's line, which a rig's resolution decides.
struct LineScale {
  int fit_rows = 3;    ///< a sample is fitted to as many rows above and below it
  int edge_rows = 1;   ///< the first and the last rows of a piece of line, which are left out
  float max_jump = 3;  ///< pixels from row to row that a piece of line may go sideways
};

/// The scale of pictures in which a pixel is so wide at the object.
/// @param pixel  metres
LineScale line_scale(double pixel);

/// Finds a laser's line in the difference of a picture with the laser and one without.
///
/// In each row every local maximum of the smoothed difference is a candidate, not only the
/// brightest: a surface behind another's edge shows a second piece. A candidate's column is the
/// centre of mass of the light around it, down to a twentieth of its peak or to the valley before
/// the next one. Too wide or too little light is refused. Candidates of neighbouring rows are
/// linked to pieces; of each, the rows at its ends, where line and edge mix, are left out, and
/// columns are smoothed by a quadratic fit over the rows around, weighted by their light: that
/// halves what speckle and printed patterns add. Pieces of less than six rows are noise.
///
/// Deterministic: the same bits on x86-64 and arm64.
/// @param dark, lit  of the same size
/// @return row by row, in each from left to right
std::vector<LineSample> find_line(const Picture& dark, const Picture& lit, const LineScale& scale);

}  // namespace octurn
