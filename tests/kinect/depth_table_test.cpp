#include "kinect/depth_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace octurn {
namespace {

/// The formula solved for the depth, z = b d / (b - m), in units of 0.1 mm; infinite if b <= m.
double exact_depth(const KinectParameters& unit, int reading) {
  const double m = (reading / 4.0 - unit.shift - 0.375) * unit.reference_pixel_cm;
  return m < unit.baseline_cm
             ? 100 * unit.baseline_cm * unit.reference_distance_cm / (unit.baseline_cm - m)
             : std::numeric_limits<double>::infinity();
}

void expect_formula(const KinectParameters& unit) {
  const DepthTable table = depth_table(unit);
  int seen = 0;
  for (int reading = 0; reading < 2048; ++reading) {
    const double depth = exact_depth(unit, reading);
    const int value = table[static_cast<std::size_t>(reading)];
    if (reading == 2047 || depth > 65534) {
      EXPECT_EQ(value, 0) << reading;
    } else {
      EXPECT_NEAR(value, depth, 0.5 + 1e-6) << reading;
      ++seen;
    }
  }
  EXPECT_GT(seen, 1000);
  EXPECT_LT(seen, 1100);
}

TEST(DepthTable, IsTheFormulaForEveryReading) { expect_formula({}); }

TEST(DepthTable, IsTheFormulaForOtherUnits) {
  expect_formula(
      {.baseline_cm = 7.62, .reference_distance_cm = 121.5, .reference_pixel_cm = 0.1047});
  expect_formula({.baseline_cm = 7.4, .shift = 195});
}

TEST(DepthTable, AgreesWithWhatFitsRealFrames) {
  const DepthTable table = depth_table({});
  for (int reading = 0; reading < 1000; ++reading) {
    const double depth = 3454890 / (1089.40 - reading);
    // Rounding to half a unit, and one unit in the last digit of both constants.
    const double tolerance = 0.5 + depth * (1.0 / 345489 + 0.01 / (1089.40 - reading));
    EXPECT_NEAR(table[static_cast<std::size_t>(reading)], depth, tolerance) << reading;
  }
}

// The table is the same on every machine, so that models are the same to the bit.
TEST(DepthTable, HasTheSameBitsEverywhere) {
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const std::uint16_t depth : depth_table({})) {
    for (const unsigned byte : {depth & 0xFFU, unsigned{depth} >> 8U}) {
      hash = (hash ^ byte) * 16777619U;
    }
  }
  EXPECT_EQ(hash, 2687301684U);
}

TEST(DepthTable, GrowsWithTheReading) {
  const DepthTable table = depth_table({});
  std::size_t reading = 1;
  for (; table[reading] != 0; ++reading) {
    EXPECT_GT(table[reading], table[reading - 1]) << reading;
  }
  EXPECT_GT(reading, 1000U);  // those of depths up to 6 m
}

TEST(KinectParameters, GiveTheFocalLengthOfATypicalUnit) {
  EXPECT_NEAR(KinectParameters{}.focal_length(), 575.8, 0.05);
}

}  // namespace
}  // namespace octurn
