#include "simulator/white_noise.hpp"

#include <cmath>

#include "simulator/noise_field.hpp"

namespace octurn {
namespace {

constexpr std::size_t size = std::size_t{1} << 17U;
constexpr std::uint32_t terms = 12;  // of a sum of uniform numbers, whose variance is then 1

}  // namespace

WhiteNoise::WhiteNoise(std::uint32_t seed) : values_(size) {
  for (std::size_t i = 0; i < size; ++i) {
    float sum = -static_cast<float>(terms) / 2;
    for (std::uint32_t term = 0; term < terms; ++term) {
      const std::uint32_t drawn = mixed(seed, static_cast<std::uint32_t>(i) * terms + term);
      sum += static_cast<float>(drawn) * 0x1p-32F;
    }
    values_[i] = sum;
  }
}

}  // namespace octurn
