#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "calibrate/stop_residuals.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

std::vector<double> even_angles(int stops) {
  std::vector<double> angles;
  for (int stop = 0; stop < stops; ++stop) {
    angles.push_back(2 * std::numbers::pi * stop / stops);
  }
  return angles;
}

/// The angles between the stops of each pair, rounded to whole degrees.
std::set<long> apart_deg(const std::vector<double>& angles) {
  std::set<long> apart;
  for (const StopPair& pair : make_stop_pairs(angles)) {
    apart.insert(std::lround(std::abs(degrees_from_radians(
        std::remainder(angles[pair.to] - angles[pair.from], 2 * std::numbers::pi)))));
  }
  return apart;
}

TEST(StopPairs, AreThoseApartByAnglesThatTellTheAxis) {
  EXPECT_EQ(apart_deg(even_angles(24)), (std::set<long>{15, 30, 45, 75}));
  EXPECT_EQ(apart_deg(even_angles(12)), (std::set<long>{30, 90}));
  EXPECT_EQ(apart_deg(even_angles(8)), (std::set<long>{45, 90}));
}

TEST(StopPairs, AreNeighboursWhereThereAreFewStops) {
  EXPECT_EQ(apart_deg(even_angles(4)), (std::set<long>{90}));
  EXPECT_EQ(make_stop_pairs(even_angles(4)).size(), 8U);  // four neighbours in both directions
}

TEST(StopPairs, AreNoneWhereStopsSeeDifferentSides) {
  EXPECT_TRUE(make_stop_pairs(even_angles(2)).empty());
  EXPECT_TRUE(make_stop_pairs(even_angles(3)).empty());
  EXPECT_TRUE(make_stop_pairs({0.0}).empty());
  EXPECT_TRUE(make_stop_pairs({}).empty());
}

TEST(StopPairs, GoInBothDirectionsAndInTheOrderOfTheFirst) {
  const auto pairs = make_stop_pairs(even_angles(36));
  EXPECT_TRUE(std::ranges::is_sorted(pairs, {}, &StopPair::from));
  for (const StopPair& pair : pairs) {
    EXPECT_NE(pair.from, pair.to);
    EXPECT_EQ(std::ranges::count_if(pairs,
                                    [&](const StopPair& other) {
                                      return other.from == pair.from && other.to == pair.to;
                                    }),
              1);
  }
}

}  // namespace
}  // namespace octurn
