#include "calibrate/platform_samples.hpp"

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"

namespace octurn {
PlatformSamples make_platform_samples(const Intrinsics& lens, std::size_t stops) {
  PlatformSamples samples{
      .columns = static_cast<std::size_t>((lens.width + platform_step - 1) / platform_step),
      .rays = {},
      .depths = std::vector<std::vector<float>>(stops)};
  for (int v = 0; v < lens.height; v += platform_step) {
    for (int u = 0; u < lens.width; u += platform_step) {
      samples.rays.push_back(to_ray(lens, u, v));
    }
  }
  return samples;
}

std::vector<float> sample_depths(const DepthFrame& frame, const Intrinsics& lens) {
  check_size(frame, lens, "calibrate");
  std::vector<float> depths;
  for (int v = 0; v < frame.height; v += platform_step) {
    for (int u = 0; u < frame.width; u += platform_step) {
      const auto z = static_cast<float>(
          frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                      static_cast<std::size_t>(u)] *
          lens.depth_unit);
      depths.push_back(static_cast<double>(z) > nearest_z ? z : 0.0F);
    }
  }
  return depths;
}

}  // namespace octurn
