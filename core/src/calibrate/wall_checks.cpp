#include "calibrate/wall_checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "io/number_text.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

// Limits of a flat wall. Units are steps of a Kinect's disparity.
constexpr double min_coverage = 0.9;
constexpr double max_slant_deg = 20;
constexpr double max_wall_distance = 2;  // metres: the map is for objects at 0.5 to 1 m
constexpr double far_off = 4;            // units from the plane; a sensor's own error is less
constexpr double max_far_off = 0.05;     // share of the blocks
constexpr double min_step = 3;           // units between cells of 8 pixels that are 16 pixels apart
constexpr double max_steps = 0.005;      // share of such pairs

/// Share of the known blocks that lie off the plane.
double far_off_share(const BlockValues& residuals) {
  double off = 0;
  double all = 0;
  for (std::size_t i = 0; i < residuals.values.size(); ++i) {
    all += residuals.weights[i];
    off += std::abs(residuals.values[i]) > far_off * disparity_unit ? residuals.weights[i] : 0;
  }
  return off / std::max(all, 1.0);
}

/// Mean of a cell of 2 x 2 blocks; nothing if one of them is unknown.
std::optional<double> cell_mean(const BlockValues& grid, int column, int row) {
  double sum = 0;
  for (const int y : {row, row + 1}) {
    for (const int x : {column, column + 1}) {
      const auto at = static_cast<std::size_t>(y * grid.columns + x);
      if (grid.weights[at] == 0) {
        return std::nullopt;
      }
      sum += grid.values[at];
    }
  }
  return sum / 4;
}

/// Share of the pairs of neighbouring cells between which the wall steps: the edge of something.
double step_share(const BlockValues& grid) {
  constexpr int apart = 4;  // blocks
  int steps = 0;
  int pairs = 0;
  for (int row = 0; row + apart + 1 < grid.rows; row += 2) {
    for (int column = 0; column + apart + 1 < grid.columns; column += 2) {
      const auto here = cell_mean(grid, column, row);
      for (const auto& there :
           {cell_mean(grid, column + apart, row), cell_mean(grid, column, row + apart)}) {
        if (here && there) {
          ++pairs;
          steps += std::abs(*here - *there) > min_step * disparity_unit ? 1 : 0;
        }
      }
    }
  }
  return steps / std::max(1.0, static_cast<double>(pairs));
}

}  // namespace

void drop_outliers(BlockValues& residuals) {
  for (std::size_t i = 0; i < residuals.values.size(); ++i) {
    if (std::abs(residuals.values[i]) > far_off * disparity_unit) {
      residuals.values[i] = 0;
      residuals.weights[i] = 0;
    }
  }
}

std::string refuse_wall(const WallBlocks& wall, const WallPlane& plane,
                        const BlockValues& residuals) {
  if (wall.coverage < min_coverage) {
    return "only " + percent_text(wall.coverage) +
           " of the picture has readings: have the sensor look at a bare, matt wall 0.6 to 0.9 m "
           "away";
  }
  if (const double off = far_off_share(residuals); off > max_far_off) {
    return "that is no flat wall: " + percent_text(off) +
           " of the picture lies off its plane, as of a corner, a person or a picture frame";
  }
  if (const double slant = degrees_from_radians(plane.slant()); slant > max_slant_deg) {
    return "the wall is slanted by " + number_text("%.0f", slant) +
           " degrees: have the sensor look at it more squarely";
  }
  if (plane.distance() > max_wall_distance) {
    return "the wall is " + number_text("%.1f", plane.distance()) +
           " m away: 0.6 to 0.9 m is the distance of an object";
  }
  if (step_share(residuals) > max_steps) {
    return "something hangs on the wall or stands before it: take a bare one";
  }
  return {};
}

}  // namespace octurn
