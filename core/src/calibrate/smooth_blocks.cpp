#include "calibrate/smooth_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace octurn {
namespace {

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

}  // namespace

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

}  // namespace octurn
