#include "http/preview_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "octurn/depth_png.hpp"

namespace octurn {
namespace {

constexpr int width = 320;
constexpr int height = 240;

// Brightness goes with 1 / distance, as the sensor's own resolution does. A Kinect v1 sees nothing
// nearer than 0.45 m, and what stands behind a platform is rarely farther than 2 m.
constexpr double nearest = 0.45;  // metres
constexpr double farthest = 2.0;
constexpr double darkest = 24;  // so that far is told from no reading

std::uint8_t brightness(double distance) {
  if (distance <= 0) {
    return 0;
  }
  const double share = (1 / distance - 1 / farthest) / (1 / nearest - 1 / farthest);
  return static_cast<std::uint8_t>(
      std::lround(darkest + (255 - darkest) * std::clamp(share, 0.0, 1.0)));
}

}  // namespace

std::string preview_png(const DepthFrame& frame, double depth_unit) {
  std::vector<std::uint8_t> picture;
  picture.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    const int row = y * frame.height / height * frame.width;
    for (int x = 0; x < width; ++x) {
      const auto sample = static_cast<std::size_t>(row + x * frame.width / width);
      picture.push_back(brightness(frame.depth[sample] * depth_unit));
    }
  }
  const std::vector<std::byte> png = encode_grey_png(width, height, picture);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

}  // namespace octurn
