#include "http/preview_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {
namespace {

constexpr int width = 320;
constexpr int height = 240;

// Brightness is linear in inverse depth, as the sensor's resolution is. A Kinect v1 measures from
// 0.45 m; 2 m is behind any platform.
constexpr double min_depth = 0.45;  // metres
constexpr double max_depth = 2.0;
constexpr double min_brightness = 24;  // distinguishes far from no reading

std::uint8_t to_brightness(double depth) {
  if (depth <= 0) {
    return 0;
  }
  const double share = (1 / depth - 1 / max_depth) / (1 / min_depth - 1 / max_depth);
  return static_cast<std::uint8_t>(
      std::lround(min_brightness + (255 - min_brightness) * std::clamp(share, 0.0, 1.0)));
}

/// @param brightness  of a sample by its index
template <typename Brightness>
std::string sampled_png(int from_width, int from_height, Brightness brightness) {
  std::vector<std::uint8_t> picture;
  picture.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    const int row = y * from_height / height * from_width;
    for (int x = 0; x < width; ++x) {
      picture.push_back(brightness(static_cast<std::size_t>(row + x * from_width / width)));
    }
  }
  const std::vector<std::byte> png = encode_grey_png(width, height, picture);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

}  // namespace

std::string preview_png(const DepthFrame& frame, double depth_unit) {
  return sampled_png(frame.width, frame.height, [&](std::size_t sample) {
    return to_brightness(frame.depth[sample] * depth_unit);
  });
}

std::string preview_png(const Picture& picture) {
  return sampled_png(picture.width, picture.height,
                     [&](std::size_t sample) { return picture.samples[sample]; });
}

}  // namespace octurn
