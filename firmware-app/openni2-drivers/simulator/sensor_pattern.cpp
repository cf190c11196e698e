#include "simulator/sensor_pattern.hpp"

#include <cmath>
#include <numbers>

#include "simulator/camera.hpp"
#include "simulator/noise_field.hpp"

namespace octurn {
namespace {

constexpr double error_rms = 0.8;              // readings
constexpr double correlation = 50;             // pixels, to 1/e
constexpr double changing = 0.4;               // share that differs between 0.65 and 0.9 m
constexpr double change = 1 / 0.65 - 1 / 0.9;  // 1/m
constexpr std::uint32_t waves = 80;
constexpr int grid = 4;  // pixels between computed samples: waves are 80 pixels and longer

/// A random, smooth field: the sum of waves in random directions whose wave numbers are drawn so
/// that the field's correlation is exp(-(d / correlation)^2) ("random Fourier features", Rahimi and
/// Recht 2007). Its root mean square is 1. Sampled every `grid` pixels, and once beyond the
/// picture.
std::vector<float> smooth_field(std::uint32_t seed) {
  constexpr int columns = camera.width / grid + 1;
  constexpr int rows = camera.height / grid + 1;
  const auto even = [seed](std::uint32_t number) {
    return (mixed(seed, number) + 0.5) / 4294967296.0;
  };
  std::vector<double> sum(std::size_t{columns} * rows, 0.0);
  for (std::uint32_t wave = 0; wave < waves; ++wave) {
    // Box and Muller: two normal numbers of variance 2 / correlation^2.
    const double size = std::sqrt(-4 * std::log(even(3 * wave))) / correlation;
    const double heading = 2 * std::numbers::pi * even(3 * wave + 1);
    const double start = 2 * std::numbers::pi * even(3 * wave + 2);
    const double along_u = grid * size * std::cos(heading);
    const double along_v = grid * size * std::sin(heading);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        sum[static_cast<std::size_t>(row * columns + column)] +=
            std::cos(start + along_u * column + along_v * row);
      }
    }
  }
  double squares = 0;
  for (const double value : sum) {
    squares += value * value / static_cast<double>(sum.size());
  }
  std::vector<float> field;
  field.reserve(sum.size());
  for (const double value : sum) {
    field.push_back(static_cast<float>(value / std::sqrt(squares)));
  }
  return field;
}

/// Interpolates a smooth field bilinearly.
float value_at(const std::vector<float>& field, int u, int v) {
  constexpr int columns = camera.width / grid + 1;
  const float* corner = field.data() + static_cast<std::ptrdiff_t>(v / grid) * columns + u / grid;
  const float x = static_cast<float>(u % grid) / grid;
  const float y = static_cast<float>(v % grid) / grid;
  const float above = corner[0] + x * (corner[1] - corner[0]);
  const float below = corner[columns] + x * (corner[columns + 1] - corner[columns]);
  return above + y * (below - above);
}

}  // namespace

SensorPattern::SensorPattern(std::uint32_t seed, double share)
    : near_(pixels(camera), 0.0F), slope_(pixels(camera), 0.0F) {
  if (share <= 0) {
    return;
  }
  // No other random number of the simulator is drawn with these seeds.
  const std::vector<float> here = smooth_field(mixed(seed, 0x70617474));
  const std::vector<float> there = smooth_field(mixed(seed, 0x6368616E));
  const auto size = static_cast<float>(share * error_rms);
  const auto stays = static_cast<float>(std::sqrt(1 - changing * changing));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto at = static_cast<std::size_t>(v * camera.width + u);
      const float near = value_at(here, u, v);
      const float far = stays * near + static_cast<float>(changing) * value_at(there, u, v);
      near_[at] = size * near;
      slope_[at] = size * (near - far) / static_cast<float>(change);
    }
  }
}

}  // namespace octurn
