#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"

namespace octurn {

/// A pixel's inverse depth as a function of its column and row, 1/m.
using InverseDepthAt = std::function<double(int u, int v)>;

/// A wall at a distance along the optical axis (metres), turned about the picture's vertical.
inline InverseDepthAt flat_wall(double distance, double slant_deg) {
  return [=, tangent = std::tan(radians_from_degrees(slant_deg))](int u, int /*v*/) {
    const Intrinsics lens;
    return (1 - tangent * (u - lens.cx) / lens.fx) / distance;
  };
}

/// A smooth error pattern, 1/m: 0.8 steps of disparity (root mean square) at 0.65 m, in waves of
/// 200 pixels or more. A second pattern of two fifths that size grows linearly in inverse depth,
/// and has that size 0.43 1/m farther away.
inline double pattern_error(int u, int v, double inverse_depth) {
  const auto wave = [&](double along_u, double along_v, double start) {
    return std::sin(2 * std::numbers::pi * (along_u * u + along_v * v) + start);
  };
  const double stays = wave(1 / 220.0, 1 / 310.0, 0.3) + wave(-1 / 290.0, 1 / 240.0, 1.9);
  const double changes = wave(1 / 260.0, -1 / 200.0, 2.2) + wave(1 / 330.0, 1 / 225.0, 4.0);
  const double farther = (1 / 0.65 - inverse_depth) / 0.43;
  return 0.8 * disparity_unit * (stays + 0.4 * farther * changes);
}

/// One frame of a sensor with that pattern, noise of up to half a step, and depth quantised in
/// steps of disparity.
inline DepthFrame wall_frame(const InverseDepthAt& wall, std::mt19937& random) {
  constexpr double infinity = 1089.40;  // a Kinect v1's raw reading at infinite depth, no integer
  const Intrinsics lens;
  DepthFrame frame{.width = lens.width, .height = lens.height, .depth = {}};
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const double inverse_depth = wall(u, v);
      const double noise =
          static_cast<double>(random()) / 4294967296.0 - 0.5;  // the same on every machine
      const double reading = std::round(
          infinity - (inverse_depth + pattern_error(u, v, inverse_depth)) / disparity_unit + noise);
      const double depth = 1 / ((infinity - reading) * disparity_unit * lens.depth_unit);
      frame.depth.push_back(inverse_depth > 0 ? static_cast<std::uint16_t>(std::lround(depth))
                                              : std::uint16_t{0});
    }
  }
  return frame;
}

inline WallView wall_view(const InverseDepthAt& wall, int frames = 4, unsigned seed = 1) {
  std::mt19937 random(seed);
  WallView view{Intrinsics{}};
  for (int frame = 0; frame < frames; ++frame) {
    view.add(wall_frame(wall, random));
  }
  return view;
}

}  // namespace octurn
