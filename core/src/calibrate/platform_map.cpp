#include "calibrate/platform_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

constexpr std::size_t block_samples = 8;  // to a side of a block, of 4 pixels each
constexpr std::size_t min_samples = block_samples * block_samples / 2;  // in a block
constexpr std::size_t min_blocks = 6;

/// For each sample on the plane its mean distance from it over all stops, units of disparity.
double mean_difference(const PlatformSamples& samples, const PlatformPlane& plane,
                       std::size_t sample) {
  const double expected = plane.normal.dot(samples.rays[sample]) / plane.offset;
  double sum = 0;
  std::size_t count = 0;
  for (const std::vector<float>& depths : samples.depths) {
    const auto z = static_cast<double>(depths[sample]);
    if (z > 0) {
      sum += 1 / z - expected;
      ++count;
    }
  }
  return sum / (disparity_unit * static_cast<double>(count));
}

}  // namespace

std::optional<double> measure_platform_map(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane) {
  struct Sum {
    double differences = 0;
    std::size_t count = 0;
  };
  const std::size_t blocks_in_row = samples.columns / block_samples + 1;
  std::vector<Sum> sums((samples.rays.size() / samples.columns / block_samples + 1) *
                        blocks_in_row);
  for (std::size_t sample = 0; sample < samples.rays.size(); ++sample) {
    if (is_plane[sample]) {
      Sum& sum = sums[sample / samples.columns / block_samples * blocks_in_row +
                      sample % samples.columns / block_samples];
      sum.differences += mean_difference(samples, plane, sample);
      ++sum.count;
    }
  }
  double squares = 0;
  std::size_t blocks = 0;
  for (const Sum& sum : sums) {
    if (sum.count >= min_samples) {
      const double mean = sum.differences / static_cast<double>(sum.count);
      squares += mean * mean;
      ++blocks;
    }
  }
  return blocks >= min_blocks ? std::optional(std::sqrt(squares / static_cast<double>(blocks)))
                              : std::nullopt;
}

}  // namespace octurn
