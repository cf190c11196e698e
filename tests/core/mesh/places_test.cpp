#include "mesh/places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace octurn {
namespace {

using Eigen::Vector3d;

TEST(Places, AreTheCellsOfFourMillimetresThatHoldPoints) {
  Places places;
  places.add({0.001, 0.001, 0.001});
  places.add({0.0039, 0.0001, 0.002});
  places.add({-0.001, 0.001, 0.005});
  EXPECT_EQ(places.centres(),
            (std::vector<Vector3d>{{-0.002, 0.002, 0.006}, {0.002, 0.002, 0.002}}));
}

TEST(Places, GrowCoarserWhenThereAreManyInsteadOfMore) {
  Places places;
  for (int i = 0; i < 1000; ++i) {
    places.add({(i + 0.5) * 0.004, 0, 0});
  }
  // 1,000 cells of 4 mm in a row are merged into 250 of 16 mm.
  const std::vector<Vector3d> centres = places.centres();
  ASSERT_EQ(centres.size(), 250U);
  EXPECT_NEAR((centres[1] - centres[0]).norm(), 0.016, 1e-12);
}

TEST(Places, AreTheSameInWhateverOrderThePointsCome) {
  std::mt19937 random(3);
  std::vector<Vector3d> points;
  for (int i = 0; i < 2000; ++i) {
    const auto next = [&] { return static_cast<double>(random()) / 4294967296.0 * 0.3 - 0.15; };
    points.emplace_back(next(), next(), next());
  }
  Places forwards;
  Places backwards;
  for (const Vector3d& point : points) {
    forwards.add(point);
  }
  std::ranges::reverse(points);
  for (const Vector3d& point : points) {
    backwards.add(point);
  }
  EXPECT_EQ(forwards.centres(), backwards.centres());
  EXPECT_LE(forwards.centres().size(), Places::max_count);
}

TEST(Places, CoverALargeFacet) {
  Places places;
  places.add({Vector3d(0, 0, 0.001), Vector3d(0.04, 0, 0.001), Vector3d(0, 0.04, 0.001)});
  // Half of 10 x 10 cells, plus the cells along the diagonal edge.
  EXPECT_GE(places.centres().size(), 45U);
  EXPECT_LE(places.centres().size(), 66U);
}

}  // namespace
}  // namespace octurn
