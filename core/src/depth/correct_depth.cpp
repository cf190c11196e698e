#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "depth/depth_limits.hpp"
#include "io/radial_distortion.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/snapshot.hpp"

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

namespace {

// Metres between neighbouring readings of one surface: at 0.65 m and 75 degrees it is 3.5 mm.
constexpr double max_step = 0.01;

/// Reads a depth image between its pixels.
class DepthSampler {
 public:
  DepthSampler(const DepthFrame& frame, double depth_unit)
      : frame_(frame), max_step_(max_step / depth_unit) {}

  /// Bilinear between four readings of one surface, else the nearest pixel's reading.
  /// @return depth units; 0 without a reading or outside the image
  double operator()(double u, double v) const {
    if (!(u >= 0 && v >= 0 && u < frame_.width - 1 && v < frame_.height - 1)) {
      return nearest(u, v);
    }
    const auto left = static_cast<int>(u);  // several times as fast as std::floor
    const auto top = static_cast<int>(v);
    const auto width = static_cast<std::size_t>(frame_.width);
    const std::uint16_t* above =
        &frame_.depth[static_cast<std::size_t>(top) * width + static_cast<std::size_t>(left)];
    const std::uint16_t* below = above + width;
    const auto [least, most] = std::minmax({above[0], above[1], below[0], below[1]});
    if (least == 0 || most - least > max_step_) {
      return nearest(u, v);
    }
    const double x = u - left;
    const double upper = above[0] + x * (above[1] - above[0]);
    const double lower = below[0] + x * (below[1] - below[0]);
    return upper + (v - top) * (lower - upper);
  }

 private:
  double nearest(double u, double v) const {
    const double column = u + 0.5;
    const double row = v + 0.5;
    if (!(column >= 0 && row >= 0 && column < frame_.width && row < frame_.height)) {
      return 0;
    }
    return frame_.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(frame_.width) +
                        static_cast<std::size_t>(column)];
  }

  const DepthFrame& frame_;
  double max_step_;
};

std::uint16_t rounded_depth(double units) {
  return static_cast<std::uint16_t>(
      std::clamp(units + 0.5, 1.0, static_cast<double>(std::numeric_limits<std::uint16_t>::max())));
}

}  // namespace

Intrinsics rectified(Intrinsics sensor, const SensorOptics& optics) {
  sensor.fx = optics.fx;
  sensor.fy = optics.fy;
  sensor.cx = optics.cx;
  sensor.cy = optics.cy;
  sensor.depth_unit *= optics.depth_scale;
  return sensor;
}

DepthFrame rectified(DepthFrame frame, const Intrinsics& sensor, const SensorOptics& optics) {
  check_size(frame, sensor, "rectified");
  const RadialDistortion distortion{.k1 = optics.k1, .k2 = optics.k2};
  const double offset = optics.depth_offset_per_m * sensor.depth_unit;
  if (distortion.k1 == 0 && distortion.k2 == 0 && offset == 0) {
    return frame;
  }
  const DepthSampler sample(frame, sensor.depth_unit);
  DepthFrame pinhole{.width = frame.width, .height = frame.height, .depth = {}};
  pinhole.depth.reserve(frame.depth.size());
  std::vector<double> columns;
  for (int u = 0; u < frame.width; ++u) {
    columns.push_back((u - optics.cx) / optics.fx);
  }
  for (int v = 0; v < frame.height; ++v) {
    const double y = (v - optics.cy) / optics.fy;
    for (int u = 0; u < frame.width; ++u) {
      const double x = columns[static_cast<std::size_t>(u)];
      const double shift = distortion.shift(x * x + y * y);
      const double depth = sample(u + optics.fx * x * shift, v + optics.fy * y * shift);
      pinhole.depth.push_back(depth > 0 ? rounded_depth(depth / (1 + offset * depth)) : 0);
    }
  }
  return pinhole;
}

}  // namespace octurn
