#include <gtest/gtest.h>

#include <vector>

#include "octurn/snapshot.hpp"
#include "tsdf/facet_stream.hpp"

namespace octurn {
namespace {

std::vector<Facet> facets(std::size_t count, std::uint16_t mark) {
  return std::vector<Facet>(count, Facet{.attributes = mark});
}

TEST(KeptFacets, AreGivenInTheOrderInWhichTheyCame) {
  KeptFacets kept(5 * sizeof(Facet));
  kept.add(facets(3, 1));
  kept.add(facets(2, 2));
  ASSERT_TRUE(kept.is_whole());
  std::vector<int> marks;
  kept.stream(
      [&](std::span<const Facet> some) {
        for (const Facet facet : some) {
          marks.push_back(facet.attributes);
        }
      },
      {});
  EXPECT_EQ(marks, (std::vector{1, 1, 1, 2, 2}));
}

TEST(KeptFacets, AreNoneIfTheyDoNotFit) {
  KeptFacets kept(5 * sizeof(Facet));
  kept.add(facets(3, 1));
  kept.add(facets(3, 2));
  EXPECT_FALSE(kept.is_whole());
  kept.add(facets(1, 3));
  EXPECT_FALSE(kept.is_whole());
}

TEST(KeptFacets, EndAtAStop) {
  KeptFacets kept(5 * sizeof(Facet));
  kept.add(facets(1, 1));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(kept.stream([](std::span<const Facet>) { FAIL(); }, stop.get_token()), Stopped);
}

}  // namespace
}  // namespace octurn
