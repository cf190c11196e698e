#pragma once

#include <cstdint>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// Where a laser's line crosses one row of a picture.
struct LineSample {
  float u = 0;             ///< column, pixels, with sub-pixel accuracy
  float light = 0;         ///< grey levels, the sum over the line's width
  int row = 0;             ///< of the picture
  std::int32_t next = -1;  ///< index of the sample that continues the line in the next row, or -1
};

/// Windows of the line detection in pixels, which follow from the rig's resolution.
struct LineScale {
  int fit_rows = 3;    ///< rows above and below a sample that its fit includes
  int edge_rows = 1;   ///< rows dropped at each end of a piece of line
  float max_jump = 3;  ///< maximum change of the column from row to row
};

/// Returns the windows for a resolution.
/// @param pixel  width of a pixel at the object, metres
LineScale line_scale(double pixel);

/// Finds a laser's line in the difference of a picture with the laser and one without.
///
/// In each row every local maximum of the smoothed difference is a candidate, not only the
/// brightest: a surface behind another's edge shows a second piece. A candidate's column is the
/// centre of mass of the light around it, down to a twentieth of its peak or to the valley before
/// the next one. Candidates that are too wide or too dim are dropped. Candidates of neighbouring
/// rows are linked to pieces. The rows at both ends of a piece, where line and edge mix, are
/// dropped. Columns are smoothed by a quadratic fit over the neighbouring rows, weighted by their
/// light, which halves the noise from speckle and printed patterns. Pieces of fewer than six rows
/// are dropped as noise.
///
/// Deterministic: the same bits on x86-64 and arm64.
/// @param dark, lit  of the same size
/// @return sorted by row, then column
std::vector<LineSample> find_line(const Picture& dark, const Picture& lit, const LineScale& scale);

}  // namespace octurn
