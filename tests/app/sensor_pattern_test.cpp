#include "simulator/sensor_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "octurn/sensor_map.hpp"
#include "simulator/scene.hpp"

namespace octurn {
namespace {

constexpr float at_65_cm = 1 / 0.65F;
constexpr float at_90_cm = 1 / 0.90F;

std::vector<float> errors(const SensorPattern& pattern, float inverse_depth) {
  std::vector<float> errors;
  for (std::size_t pixel = 0; pixel < std::size_t{640} * 480; ++pixel) {
    errors.push_back(pattern.error(pixel, inverse_depth));
  }
  return errors;
}

/// Mean product of the errors of pixels that are `columns` columns apart.
double product(const std::vector<float>& a, const std::vector<float>& b, int columns) {
  double sum = 0;
  for (std::size_t row = 0; row < 480; ++row) {
    for (std::size_t u = 0; u + static_cast<std::size_t>(columns) < 640; ++u) {
      sum += static_cast<double>(a[row * 640 + u]) *
             static_cast<double>(b[row * 640 + u + static_cast<std::size_t>(columns)]);
    }
  }
  return sum / (480.0 * (640 - columns));
}

TEST(SensorPattern, HasEightTenthsOfAReadingAndIsSmooth) {
  const std::vector<float> near = errors(SensorPattern(3, 1), at_65_cm);
  const double square = product(near, near, 0);
  EXPECT_NEAR(std::sqrt(square), 0.8, 0.02);
  EXPECT_GT(product(near, near, 10) / square, 0.9);
  // The correlation is 1/e at 50 pixels, estimated from some 10 x 13 independent places.
  EXPECT_NEAR(product(near, near, 50) / square, 0.37, 0.25);
}

TEST(SensorPattern, ChangesByTwoFifthsOverTheDistance) {
  const SensorPattern pattern(3, 1);
  const std::vector<float> near = errors(pattern, at_65_cm);
  const std::vector<float> far = errors(pattern, at_90_cm);
  EXPECT_NEAR(std::sqrt(product(far, far, 0)), 0.8, 0.15);
  const double correlation =
      product(near, far, 0) / std::sqrt(product(near, near, 0) * product(far, far, 0));
  EXPECT_NEAR(correlation, std::sqrt(1 - 0.4 * 0.4), 0.1);
}

TEST(SensorPattern, IsAnotherForEachSeedAndNoneWithoutAShare) {
  EXPECT_EQ(errors(SensorPattern(3, 1), at_65_cm), errors(SensorPattern(3, 1), at_65_cm));
  const std::vector<float> one = errors(SensorPattern(3, 1), at_65_cm);
  const std::vector<float> other = errors(SensorPattern(4, 1), at_65_cm);
  EXPECT_LT(std::abs(product(one, other, 0)), 0.3 * 0.64);
  for (const float error : errors(SensorPattern(3, 0), at_90_cm)) {
    ASSERT_EQ(error, 0);
  }
}

TEST(SceneOfAWall, IsFlatAndSquareAtItsDistance) {
  const InverseDepth wall = Scene::of_wall(0.8).lit_at(0);
  ASSERT_FALSE(wall.empty());
  for (const float inverse_depth : wall) {
    ASSERT_NEAR(inverse_depth, 1 / 0.8, 1e-5);
  }
}

}  // namespace
}  // namespace octurn
