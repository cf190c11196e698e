#include "voxel/octree.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "support/random.hpp"

namespace octurn {
namespace {

TEST(Octree, LeavesAreTheFirstLevelAtOrBelowTheMinimumLeafSize) {
  EXPECT_EQ(Octree::level_for(1.0, 0.005), 8);  // 3.9 mm: the same tree for 4 mm and 5 mm
  EXPECT_EQ(Octree::level_for(1.0, 0.004), 8);
  EXPECT_EQ(Octree::level_for(1.0, 0.001), 10);
  EXPECT_EQ(Octree::level_for(1.0, 0.25), 2);  // exactly the minimum leaf size
  EXPECT_EQ(Octree::level_for(1.0, 1.0), 0);
}

TEST(Octree, KnowsTheBricksThatWereSetAndNoOthers) {
  constexpr int levels = 7;
  Octree octree(1.0, levels);
  Random random(3);
  const auto coordinate = [&] { return random.between(0, (1 << levels) - 1); };
  std::set<std::tuple<int, int, int>> expected;
  for (int i = 0; i < 2000; ++i) {
    const Index3 leaf{coordinate(), coordinate(), coordinate()};
    octree.set(leaf);
    expected.insert({leaf.x, leaf.y, leaf.z});
  }
  EXPECT_EQ(octree.leaf_count(), expected.size());
  for (int i = 0; i < 2000; ++i) {
    const Index3 leaf{coordinate(), coordinate(), coordinate()};
    const Brick* brick = octree.find({leaf.x / 8, leaf.y / 8, leaf.z / 8});
    const bool is_set = brick != nullptr && (brick->layers[static_cast<std::size_t>(leaf.z % 8)] >>
                                                 (leaf.x % 8 + 8 * (leaf.y % 8)) &
                                             1) != 0;
    EXPECT_EQ(is_set, expected.contains({leaf.x, leaf.y, leaf.z}));
  }
  for (const auto& [x, y, z] : expected) {
    EXPECT_NE(octree.find({x / 8, y / 8, z / 8}), nullptr);
  }
}

TEST(Octree, FindsNothingOutsideTheRoot) {
  Octree octree(1.0, 5);
  octree.set({0, 0, 0});
  octree.set({31, 31, 31});
  EXPECT_NE(octree.find({0, 0, 0}), nullptr);
  EXPECT_NE(octree.find({3, 3, 3}), nullptr);
  EXPECT_EQ(octree.find({-1, 0, 0}), nullptr);
  EXPECT_EQ(octree.find({0, 0, 4}), nullptr);
}

TEST(Octree, VisitsBricksInAnOrderThatDependsOnThemAlone) {
  std::vector<Index3> leaves;
  for (int i = 0; i < 200; ++i) {
    leaves.push_back({i * 37 % 256, i * 91 % 256, i * 53 % 256});
  }
  const auto visited = [](const std::vector<Index3>& in_order) {
    Octree octree(1.0, 8);
    for (const Index3& leaf : in_order) {
      octree.set(leaf);
    }
    std::vector<std::tuple<int, int, int>> bricks;
    octree.for_each_brick(
        [&](const Index3& cell, const Brick&) { bricks.emplace_back(cell.z, cell.y, cell.x); });
    return bricks;
  };
  const auto forwards = visited(leaves);
  const auto backwards = visited({leaves.rbegin(), leaves.rend()});
  EXPECT_EQ(forwards, backwards);
  EXPECT_GT(forwards.size(), 100U);
  for (std::size_t i = 1; i < forwards.size(); ++i) {
    EXPECT_LE(std::get<0>(forwards[i - 1]), std::get<0>(forwards[i]));  // layer by layer
  }
}

TEST(Octree, MergesToTheUnionOfLeaves) {
  Octree one(1.0, 6);
  Octree other(1.0, 6);
  one.set({1, 2, 3});
  one.set({4, 4, 4});
  other.set({4, 4, 4});
  other.set({60, 61, 62});
  one.merge(other);
  EXPECT_EQ(one.leaf_count(), 3U);
  EXPECT_NE(one.find({7, 7, 7}), nullptr);
}

TEST(Octree, RefusesWhatIsNoOctree) {
  EXPECT_THROW(Octree(0.0, 3), std::invalid_argument);
  EXPECT_THROW(Octree(1.0, -1), std::invalid_argument);
  EXPECT_THROW(Octree(1.0, Octree::max_levels + 1), std::invalid_argument);
  Octree octree(1.0, 4);
  EXPECT_THROW(octree.merge(Octree(1.0, 5)), std::invalid_argument);
  EXPECT_THROW(octree.at_level(5), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
