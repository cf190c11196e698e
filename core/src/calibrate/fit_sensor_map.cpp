#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibrate/smooth_blocks.hpp"
#include "calibrate/wall_blocks.hpp"
#include "calibrate/wall_checks.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

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
