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

GreyImage reduced(const Picture& picture, int side) {
  GreyImage image{.width = picture.width / side, .height = picture.height / side};
  image.levels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      int sum = 0;
      for (int row = v * side; row < (v + 1) * side; ++row) {
        const std::size_t first =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
            static_cast<std::size_t>(u) * static_cast<std::size_t>(side);
        for (std::size_t i = 0; i < static_cast<std::size_t>(side); ++i) {
          sum += picture.samples[first + i];
        }
      }
      image.levels.push_back(static_cast<float>(sum) / static_cast<float>(side * side));
    }
  }
  return image;
}

}  // namespace octurn
