#include "kinect/depth_table.hpp"

#include <cmath>

namespace octurn {

DepthTable depth_table(const KinectParameters& parameters) {
  constexpr double farthest = 65534;  // recordings lose the largest value, 65535
  const auto& [baseline, reference, pixel, shift] = parameters;
  DepthTable depths = {};
  for (int reading = 0; reading < no_kinect_reading; ++reading) {
    const double metric_shift = ((reading - 4 * shift) / 4 - 0.375) * pixel;
    const double depth_mm = 10 * (metric_shift * reference / (baseline - metric_shift) + reference);
    const double tenths = 10 * depth_mm;
    if (metric_shift < baseline && tenths > 0 && tenths <= farthest) {
      depths[static_cast<std::size_t>(reading)] = static_cast<std::uint16_t>(std::lround(tenths));
    }
  }
  return depths;
}

}  // namespace octurn
