#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

/// Maximum extrapolation beyond the two inverse depths at which a map was measured, as a share of
/// their difference.
constexpr double max_extrapolation = 1;

/// Converts an inverse depth, 1/m, to depth units. @param largest  inverse depth of one unit, 1/m
std::uint16_t to_depth(double inverse_depth, double largest) {
  constexpr double deepest = std::numeric_limits<std::uint16_t>::max();
  if (!(inverse_depth * deepest > largest)) {
    return std::numeric_limits<std::uint16_t>::max();
  }
  return static_cast<std::uint16_t>(std::lround(std::max(1.0, largest / inverse_depth)));
}

}  // namespace

DepthFrame corrected(DepthFrame frame, const SensorMap& map, double depth_unit) {
  const auto pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  if (frame.width != map.width || frame.height != map.height || frame.depth.size() != pixels ||
      map.near.size() != pixels || (!map.far.empty() && map.far.size() != pixels)) {
    throw std::invalid_argument("corrected: the frame's size is not that of the map");
  }
  const double largest = 1 / depth_unit;
  const double between = map.near_inverse_depth - map.far_inverse_depth;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (frame.depth[i] == 0) {
      continue;
    }
    const double inverse_depth = largest / frame.depth[i];
    auto error = static_cast<double>(map.near[i]);
    if (!map.far.empty()) {
      const double share = std::clamp((map.near_inverse_depth - inverse_depth) / between,
                                      -max_extrapolation, 1 + max_extrapolation);
      error += share * (static_cast<double>(map.far[i]) - error);
    }
    frame.depth[i] = to_depth(inverse_depth - error, largest);
  }
  return frame;
}

}  // namespace octurn
