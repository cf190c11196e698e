#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/wall_blocks.hpp"
#include "io/number_text.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

/// Values on a grid, some of them unknown.
struct BlockValues {
  int columns = 0;
  int rows = 0;
  std::vector<double> values = {};   ///< columns x rows, row by row
  std::vector<double> weights = {};  ///< the same: 1 where the value is known, else 0
};

constexpr double window_sigmas = 3;  // radius of the window
constexpr double min_weight = 0.05;  // of a window's known cells, as a share of all its cells
constexpr int max_sweeps = 2000;
constexpr double settled = 1e-6;  // of a value in the largest change of a sweep

std::size_t index(const BlockValues& grid, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) +
         static_cast<std::size_t>(column);
}

std::vector<double> gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(window_sigmas * sigma));
  std::vector<double> window;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    window.push_back(std::exp(-i * i / (2 * sigma * sigma)));
    sum += window.back();
  }
  for (double& share : window) {
    share /= sum;
  }
  return window;
}

/// The window's sums along rows and columns; cells outside the grid count as 0.
std::vector<double> convolve(const BlockValues& grid, const std::vector<double>& values,
                             const std::vector<double>& window) {
  const int radius = static_cast<int>(window.size()) / 2;
  std::vector<double> along(values.size());
  std::vector<double> sums(values.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      double sum = 0;
      for (int i = std::max(-radius, -column); i <= std::min(radius, grid.columns - 1 - column);
           ++i) {
        sum += window[static_cast<std::size_t>(i + radius)] * values[index(grid, column + i, row)];
      }
      along[index(grid, column, row)] = sum;
    }
  }
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      double sum = 0;
      for (int i = std::max(-radius, -row); i <= std::min(radius, grid.rows - 1 - row); ++i) {
        sum += window[static_cast<std::size_t>(i + radius)] * along[index(grid, column, row + i)];
      }
      sums[index(grid, column, row)] = sum;
    }
  }
  return sums;
}

double mean_of_neighbours(const BlockValues& grid, const std::vector<double>& values, int column,
                          int row) {
  double sum = 0;
  int count = 0;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    if (column + dx >= 0 && column + dx < grid.columns && row + dy >= 0 && row + dy < grid.rows) {
      sum += values[index(grid, column + dx, row + dy)];
      ++count;
    }
  }
  return sum / std::max(count, 1);
}

/// Makes each unknown cell the mean of its neighbours, one after the other.
/// @return the largest change
double sweep_unknown(const BlockValues& grid, std::vector<double>& values,
                     const std::vector<bool>& is_known) {
  double change = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (const std::size_t at = index(grid, column, row); !is_known[at]) {
        const double mean = mean_of_neighbours(grid, values, column, row);
        change = std::max(change, std::abs(mean - values[at]));
        values[at] = mean;
      }
    }
  }
  return change;
}

void diffuse(const BlockValues& grid, std::vector<double>& values,
             const std::vector<bool>& is_known) {
  double largest = 0;
  for (const double value : values) {
    largest = std::max(largest, std::abs(value));
  }
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    if (sweep_unknown(grid, values, is_known) <= settled * largest) {
      return;
    }
  }
}

/// Smooths known values with a Gaussian window, then adds the smoothed residuals ("twicing", Tukey
/// 1977): long waves keep their amplitude, short ones vanish. Unknown values have no weight; far
/// from known ones they are filled by diffusion (Laplace's equation).
///
/// @param sigma  of the window, cells
/// @return columns x rows values; 0 if none is known
std::vector<double> smooth_blocks(const BlockValues& blocks, double sigma) {
  const std::vector<double> window = gaussian(sigma);
  const std::vector<double> weight = convolve(blocks, blocks.weights, window);
  std::vector<double> smooth(blocks.values.size());
  std::vector<double> left = blocks.values;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      left[i] *= blocks.weights[i];
    }
    const std::vector<double> sums = convolve(blocks, left, window);
    for (std::size_t i = 0; i < smooth.size(); ++i) {
      smooth[i] += weight[i] >= min_weight ? sums[i] / weight[i] : 0;
      left[i] = blocks.values[i] - smooth[i];
    }
  }
  std::vector<bool> is_known;
  is_known.reserve(weight.size());
  for (const double known : weight) {
    is_known.push_back(known >= min_weight);
  }
  diffuse(blocks, smooth, is_known);
  return smooth;
}

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

/// Removes blocks that lie off an accepted wall, such as a nail.
void drop_outliers(BlockValues& residuals) {
  for (std::size_t i = 0; i < residuals.values.size(); ++i) {
    if (std::abs(residuals.values[i]) > far_off * disparity_unit) {
      residuals.values[i] = 0;
      residuals.weights[i] = 0;
    }
  }
}

/// Why a view does not show a flat wall, for people; empty if it does.
/// @param residuals  of the blocks, to the plane, 1/m
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

// Limits beyond which walls are refused. Units are steps of a Kinect's disparity.
constexpr double max_rough = 1;           // units, residual of the blocks with the map
constexpr double max_disagreement = 1.5;  // units, between the errors measured on two walls

/// Sigma of the smoothing that removes speckle, which belongs to the wall: share of the picture's
/// width, 13 of 640 pixels. A sensor's own pattern is at least 50 pixels wide.
constexpr double smoothing = 0.02;

/// Ridge on the slope of the pattern over inverse depth, (1/m)^2: the larger it is, the more walls
/// must differ in inverse depth before their differences count as change and not as noise.
constexpr double caution = 0.01;
constexpr double min_difference = 0.02;  // 1/m, between two walls at different distances

/// A wall that was accepted: its residuals in blocks.
struct FlatWall {
  WallPlane plane = {};
  BlockValues residuals = {};          // 1/m
  std::vector<double> inverse_depths;  // of the plane, at each block
  std::vector<double> smooth;          // residuals without speckle
};

FlatWall to_flat_wall(const WallBlocks& wall, const WallPlane& plane) {
  FlatWall flat{.plane = plane,
                .residuals = {.columns = wall.columns, .rows = wall.rows},
                .inverse_depths = {},
                .smooth = {}};
  for (const WallBlock& block : wall.blocks) {
    const double expected = plane.inverse_depth(block.ray);
    flat.inverse_depths.push_back(expected);
    flat.residuals.values.push_back(block.is_valid ? block.inverse_depth - expected : 0);
    flat.residuals.weights.push_back(block.is_valid ? 1 : 0);
  }
  return flat;
}

/// Root mean square of the residuals less `error` of each block, 1/m.
template <typename Error>
double rms(const BlockValues& residuals, Error error) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < residuals.values.size(); ++i) {
    const double off = residuals.values[i] - error(i);
    sum += residuals.weights[i] * off * off;
    count += residuals.weights[i];
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

/// The errors of the blocks at two inverse depths.
struct BlockMap {
  double near_inverse_depth = 0;
  double far_inverse_depth = 0;
  std::vector<double> near = {};
  std::vector<double> far = {};

  double error(std::size_t block, double inverse_depth) const {
    const double between = near_inverse_depth - far_inverse_depth;
    const double share = between > 0 ? (near_inverse_depth - inverse_depth) / between : 0;
    return near[block] + share * (far[block] - near[block]);
  }
};

/// Fits a line over inverse depth to the walls' residuals at each block: least squares, with
/// `caution` as a ridge on its slope.
BlockMap combine(const std::vector<FlatWall>& walls) {
  BlockMap map{.near_inverse_depth = 0, .far_inverse_depth = 1e9};
  for (const FlatWall& wall : walls) {
    map.near_inverse_depth = std::max(map.near_inverse_depth, wall.plane.coefficients.x());
    map.far_inverse_depth = std::min(map.far_inverse_depth, wall.plane.coefficients.x());
  }
  const auto count = static_cast<double>(walls.size());
  for (std::size_t i = 0; i < walls.front().smooth.size(); ++i) {
    double mean_depth = 0;
    double mean_error = 0;
    for (const FlatWall& wall : walls) {
      mean_depth += wall.inverse_depths[i] / count;
      mean_error += wall.smooth[i] / count;
    }
    double squares = caution;
    double products = 0;
    for (const FlatWall& wall : walls) {
      const double from_mean = wall.inverse_depths[i] - mean_depth;
      squares += from_mean * from_mean;
      products += from_mean * wall.smooth[i];
    }
    const double slope = products / squares;
    map.near.push_back(mean_error + slope * (map.near_inverse_depth - mean_depth));
    map.far.push_back(mean_error + slope * (map.far_inverse_depth - mean_depth));
  }
  return map;
}

/// Bilinear between the middles of the blocks, constant outside the outermost.
std::vector<float> to_pixels(const std::vector<double>& blocks, const WallBlocks& grid,
                             const Intrinsics& lens) {
  const auto place = [](int pixel, int count) {
    constexpr double middle = (block_side - 1) / 2.0;
    return std::clamp((pixel - middle) / block_side, 0.0, static_cast<double>(count - 1));
  };
  std::vector<float> pixels;
  pixels.reserve(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  for (int v = 0; v < lens.height; ++v) {
    const double y = place(v, grid.rows);
    const int top = std::min(static_cast<int>(y), std::max(grid.rows - 2, 0));
    const int bottom = std::min(top + 1, grid.rows - 1);
    for (int u = 0; u < lens.width; ++u) {
      const double x = place(u, grid.columns);
      const int left = std::min(static_cast<int>(x), std::max(grid.columns - 2, 0));
      const int right = std::min(left + 1, grid.columns - 1);
      const auto at = [&](int column, int row) {
        return blocks[static_cast<std::size_t>(row * grid.columns + column)];
      };
      const double above = at(left, top) + (x - left) * (at(right, top) - at(left, top));
      const double below = at(left, bottom) + (x - left) * (at(right, bottom) - at(left, bottom));
      pixels.push_back(static_cast<float>(above + (y - top) * (below - above)));
    }
  }
  return pixels;
}

SensorMap to_map(const BlockMap& blocks, const WallBlocks& grid, const Intrinsics& lens) {
  SensorMap map{.width = lens.width,
                .height = lens.height,
                .near_inverse_depth = blocks.near_inverse_depth,
                .far_inverse_depth = blocks.far_inverse_depth,
                .near = to_pixels(blocks.near, grid, lens)};
  if (blocks.near_inverse_depth - blocks.far_inverse_depth > min_difference) {
    map.far = to_pixels(blocks.far, grid, lens);
  } else {
    map.far_inverse_depth = 0;
  }
  return map;
}

std::string refuse_map(const std::vector<FlatWall>& walls, const SensorMapReport& report) {
  for (std::size_t i = 1; i < walls.size(); ++i) {
    const BlockValues other{.values = walls[i].smooth, .weights = walls[i].residuals.weights};
    const double off = rms(other, [&](std::size_t at) { return walls[0].smooth[at]; });
    if (off > max_disagreement * disparity_unit) {
      return "the walls disagree: one of them is not flat, or the sensor is not warm yet";
    }
  }
  for (const WallReport& wall : report.walls) {
    if (wall.after > max_rough * disparity_unit) {
      return "the wall is rough: take a smooth one";
    }
  }
  return {};
}

void expect_one_sensor(std::span<const WallView> views) {
  const auto differs = [&](const WallView& view) {
    return view.intrinsics() != views.front().intrinsics();
  };
  if (views.empty() || std::ranges::any_of(views, differs)) {
    throw std::invalid_argument("fit_sensor_map: no views, or those of several sensors");
  }
}

std::optional<double> shortest_on_for(std::span<const WallView> views) {
  std::optional<double> shortest;
  for (const WallView& view : views) {
    if (view.on_for() && (!shortest || *view.on_for() < *shortest)) {
      shortest = view.on_for();
    }
  }
  return shortest;
}

}  // namespace

SensorMapReport fit_sensor_map(std::span<const WallView> views,
                               const std::optional<SensorOptics>& optics) {
  expect_one_sensor(views);
  const Intrinsics& lens = views.front().intrinsics();
  SensorMapReport report;
  std::vector<FlatWall> walls;
  WallBlocks grid;
  for (const WallView& view : views) {
    grid = make_wall_blocks(view, optics);
    const WallPlane plane = fit_wall_plane(grid);
    walls.push_back(to_flat_wall(grid, plane));
    report.walls.push_back(
        {.distance = plane.distance(), .slant = plane.slant(), .coverage = grid.coverage});
    if (const std::string reason = refuse_wall(grid, plane, walls.back().residuals);
        !reason.empty()) {
      report.reason =
          views.size() == 1 ? reason : "wall " + std::to_string(walls.size()) + ": " + reason;
      return report;
    }
    drop_outliers(walls.back().residuals);
    walls.back().smooth =
        smooth_blocks(walls.back().residuals, smoothing * lens.width / block_side);
  }
  const BlockMap blocks = combine(walls);
  report.map = to_map(blocks, grid, lens);
  report.map.optics = optics;
  report.map.on_for = shortest_on_for(views);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    WallReport& wall = report.walls[i];
    wall.before = rms(walls[i].residuals, [](std::size_t) { return 0.0; });
    wall.after = rms(walls[i].residuals,
                     [&](std::size_t at) { return blocks.error(at, walls[i].inverse_depths[at]); });
    report.map.before += wall.before * wall.before / static_cast<double>(walls.size());
    report.map.after += wall.after * wall.after / static_cast<double>(walls.size());
  }
  report.map.before = std::sqrt(report.map.before);
  report.map.after = std::sqrt(report.map.after);
  report.reason = refuse_map(walls, report);
  report.accepted = report.reason.empty();
  return report;
}

}  // namespace octurn
