#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

constexpr double tenth_mm = 0.0001;

SensorMap map_of(float near) {
  return {.width = 1, .height = 1, .near_inverse_depth = 1.6, .near = {near}};
}

std::uint16_t corrected_depth(std::uint16_t depth, const SensorMap& map) {
  return corrected({.width = 1, .height = 1, .depth = {depth}}, map, tenth_mm).depth[0];
}

/// The reading, in units of 0.1 mm, of a sensor whose inverse depth is too large by `error` 1/m.
/// @param depth  true depth, metres
std::uint16_t erring(double depth, double error) {
  return static_cast<std::uint16_t>(std::lround(1 / ((1 / depth + error) * tenth_mm)));
}

TEST(Corrected, LeavesEveryDepthOfASensorWithoutError) {
  for (int depth = 0; depth <= 65535; ++depth) {
    const auto given = static_cast<std::uint16_t>(depth);
    ASSERT_EQ(corrected_depth(given, map_of(0)), given);
  }
}

TEST(Corrected, TakesTheErrorFromInverseDepth) {
  for (const double depth : {0.5, 0.65, 0.9, 2.0}) {
    for (const double error : {-0.004, 0.003}) {
      // Both depths are rounded to 0.1 mm.
      EXPECT_NEAR(corrected_depth(erring(depth, error), map_of(static_cast<float>(error))),
                  depth / tenth_mm, 1)
          << depth << ", " << error;
    }
  }
}

TEST(Corrected, InterpolatesOverInverseDepthAndGoesOnForAsMuchAgain) {
  const SensorMap map{.width = 1,
                      .height = 1,
                      .near_inverse_depth = 1.6,
                      .far_inverse_depth = 1.2,
                      .near = {0.004F},
                      .far = {-0.004F}};
  for (const auto& [inverse_depth, error] : {std::pair(1.6, 0.004),
                                             {1.4, 0.0},
                                             {1.3, -0.002},
                                             {1.2, -0.004},
                                             {1.0, -0.008},
                                             {0.8, -0.012},
                                             {0.5, -0.012},
                                             {1.8, 0.008},
                                             {2.0, 0.012},
                                             {2.5, 0.012}}) {
    EXPECT_NEAR(corrected_depth(erring(1 / inverse_depth, error), map),
                1 / (inverse_depth * tenth_mm), 1.5)
        << inverse_depth;
  }
}

TEST(Corrected, IsTheFarthestDepthWhereItWouldBeFarther) {
  EXPECT_EQ(corrected_depth(60000, map_of(0.1F)), 65535);
  EXPECT_EQ(corrected_depth(60000, map_of(0.3F)), 65535);  // would be beyond infinity
  EXPECT_EQ(corrected_depth(1, map_of(-1e6F)), 1);
}

TEST(Corrected, RefusesAMapOfAnotherSize) {
  const DepthFrame frame{.width = 2, .height = 1, .depth = {1, 2}};
  EXPECT_THROW(corrected(frame, map_of(0), tenth_mm), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
