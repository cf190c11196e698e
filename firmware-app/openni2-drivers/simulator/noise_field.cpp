#include "simulator/noise_field.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

constexpr int window_width = 9;   // pixels; the correlation of real frames ends there along a row
constexpr int window_height = 3;  // and there along a column
constexpr int picture_width = 640;

/// Share of the variance that is independent of the neighbours.
constexpr double own_share = 0.15;

constexpr std::size_t noise_samples = std::size_t{1} << 17U;
constexpr std::uint32_t terms = 12;  // of a sum of uniform numbers, whose variance is then 1

}  // namespace

std::uint32_t mixed(std::uint32_t seed, std::uint32_t number) {
  std::uint32_t h = seed * 0x9E3779B9U + number;
  h = (h ^ (h >> 16U)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13U)) * 0xC2B2AE35U;
  return h ^ (h >> 16U);
}

NoiseField::NoiseField(std::uint32_t seed) {
  // Sums of uniform numbers over a window are close to normally distributed, and correlated as far
  // as windows overlap.
  constexpr std::size_t count = std::size_t{width} * height;
  std::vector<float> even(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t bits = mixed(seed, static_cast<std::uint32_t>(i)) >> 8U;
    even[i] = static_cast<float>(bits) / static_cast<float>(1U << 24U) - 0.5F;
  }
  std::vector<float> along(count);  // sums along rows
  for (int v = 0; v < height; ++v) {
    const float* row = even.data() + static_cast<std::ptrdiff_t>(v) * width;
    for (int u = 0; u < width; ++u) {
      float sum = 0;
      for (int i = 0; i < window_width; ++i) {
        sum += row[(u + i) % width];
      }
      along[static_cast<std::size_t>(v * width + u)] = sum;
    }
  }
  const auto own = static_cast<float>(std::sqrt(12 * own_share));  // the variance of `even` is 1/12
  const auto shared =
      static_cast<float>(std::sqrt(12 * (1 - own_share) / (window_width * window_height)));
  values_.resize(count);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      float sum = 0;
      for (int i = 0; i < window_height; ++i) {
        sum += along[static_cast<std::size_t>((v + i) % height * width + u)];
      }
      const auto at = static_cast<std::size_t>(v * width + u);
      const float alone = even[(at + count / 2) % count];
      const float value = one * (own * alone + shared * sum);
      values_[at] = static_cast<std::int8_t>(std::clamp(std::round(value), -127.0F, 127.0F));
    }
  }
}

std::span<const std::int8_t> NoiseField::row(std::uint32_t part, int v) const {
  constexpr std::uint32_t places = width - picture_width + 1;
  const auto down = static_cast<int>((part / places) % height);
  const auto aside = static_cast<int>(part % places);
  const int first = (v + down) % height * width + aside;
  return std::span(values_).subspan(static_cast<std::size_t>(first), picture_width);
}

WhiteNoise::WhiteNoise(std::uint32_t seed) : values_(noise_samples) {
  for (std::size_t i = 0; i < noise_samples; ++i) {
    float sum = -static_cast<float>(terms) / 2;
    for (std::uint32_t term = 0; term < terms; ++term) {
      const std::uint32_t drawn = mixed(seed, static_cast<std::uint32_t>(i) * terms + term);
      sum += static_cast<float>(drawn) * 0x1p-32F;
    }
    values_[i] = sum;
  }
}

}  // namespace octurn
