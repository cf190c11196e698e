#include "lens/grey_image.hpp"

#include <algorithm>

namespace octurn {

double GreyImage::bilinear(double u, double v) const {
  const int left = static_cast<int>(u);
  const int top = static_cast<int>(v);
  const double across = u - left;
  const double down = v - top;
  const auto level = [&](int right, int below) {
    return static_cast<double>(at(left + right, top + below));
  };
  return (1 - down) * ((1 - across) * level(0, 0) + across * level(1, 0)) +
         down * ((1 - across) * level(0, 1) + across * level(1, 1));
}

GreyImage smoothed(const GreyImage& image) {
  GreyImage rows = image;
  GreyImage both = image;
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  const auto mean = [](float before, float here, float after) {
    return 0.25F * before + 0.5F * here + 0.25F * after;
  };
  for (std::size_t v = 0; v < height; ++v) {
    const float* const from = image.levels.data() + v * width;
    for (std::size_t u = 0; u < width; ++u) {
      rows.levels[v * width + u] =
          mean(from[u == 0 ? 0 : u - 1], from[u], from[std::min(u + 1, width - 1)]);
    }
  }
  for (std::size_t v = 0; v < height; ++v) {
    const float* const here = rows.levels.data() + v * width;
    const float* const above = v == 0 ? here : here - width;
    const float* const below = v + 1 == height ? here : here + width;
    for (std::size_t u = 0; u < width; ++u) {
      both.levels[v * width + u] = mean(above[u], here[u], below[u]);
    }
  }
  return both;
}

GreyImage reduced(const GreyImage& image, int side) {
  if (side == 1) {
    return image;
  }
  GreyImage small{.width = image.width / side, .height = image.height / side};
  small.levels.reserve(static_cast<std::size_t>(small.width) *
                       static_cast<std::size_t>(small.height));
  for (int v = 0; v < small.height; ++v) {
    for (int u = 0; u < small.width; ++u) {
      float sum = 0;
      for (int row = v * side; row < (v + 1) * side; ++row) {
        for (int column = u * side; column < (u + 1) * side; ++column) {
          sum += image.at(column, row);
        }
      }
      small.levels.push_back(sum / static_cast<float>(side * side));
    }
  }
  return small;
}

GreyImage reduced(const Picture& picture, int side) {
  return reduced({.width = picture.width,
                  .height = picture.height,
                  .levels = std::vector<float>(picture.samples.begin(), picture.samples.end())},
                 side);
}

}  // namespace octurn
