#include "voxel/voxel_mask.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "voxel/connected_components.hpp"

namespace octurn {
namespace {

/// Adds the half-open box of voxels from `low` to `end`, indexed from the mask's lowest corner.
void add_block(VoxelMask& set, const Index3& low, const Index3& end) {
  for (int z = low.z; z < end.z; ++z) {
    for (int y = low.y; y < end.y; ++y) {
      for (int x = low.x; x < end.x; ++x) {
        set.row(y, z)[static_cast<std::size_t>(x) / 64] |= std::uint64_t{1} << (x % 64);
      }
    }
  }
}

/// An empty mask with several words a row, away from the lattice's origin.
VoxelMask empty_set() { return VoxelMask({16, 32, 8}, {16 + 200, 32 + 40, 8 + 40}); }

TEST(VoxelMask, RemovesANeedleInAnyDirection) {
  VoxelMask set = empty_set();
  add_block(set, {60, 10, 0}, {70, 20, 10});
  const std::uint64_t block = set.count();
  add_block(set, {70, 15, 5}, {150, 16, 6});  // across the words of a row
  add_block(set, {65, 20, 5}, {66, 35, 6});
  add_block(set, {65, 15, 10}, {66, 16, 30});
  EXPECT_GT(set.count(), block + 100);

  set.remove_spurs();

  EXPECT_EQ(set.count(), block);
  EXPECT_FALSE(set.contains(70, 15, 5));
  EXPECT_TRUE(set.contains(69, 15, 5));
}

TEST(VoxelMask, KeepsAPlateAndARing) {
  VoxelMask set = empty_set();
  add_block(set, {5, 5, 0}, {100, 6, 30});  // one voxel thick
  add_block(set, {5, 20, 0}, {30, 30, 1});
  VoxelMask hole = empty_set();
  add_block(hole, {6, 21, 0}, {29, 29, 1});
  for (int y = 0; y < set.size().y; ++y) {
    for (std::size_t word = 0; word < set.words_per_row(); ++word) {
      set.row(y, 0)[word] &= ~hole.row(y, 0)[word];
    }
  }
  const std::uint64_t count = set.count();

  set.remove_spurs();

  EXPECT_EQ(set.count(), count);
}

TEST(VoxelMask, HoldsTheSameVoxelsWhenCropped) {
  VoxelMask set = empty_set();
  add_block(set, {129, 10, 3}, {140, 12, 9});
  add_block(set, {150, 30, 20}, {151, 31, 21});

  const VoxelMask cropped = set.cropped();

  EXPECT_EQ(cropped.count(), set.count());
  EXPECT_EQ(cropped.component_count(), 2U);
  EXPECT_LT(cropped.bytes(), set.bytes() / 3);
  const Index3 shift{cropped.low().x - set.low().x, cropped.low().y - set.low().y,
                     cropped.low().z - set.low().z};
  EXPECT_TRUE(cropped.contains(129 - shift.x, 10 - shift.y, 3 - shift.z));
  EXPECT_TRUE(cropped.contains(150 - shift.x, 30 - shift.y, 20 - shift.z));
  EXPECT_EQ(empty_set().cropped().count(), 0U);
}

TEST(VoxelMask, HasAMarginWhenCroppedWhereItsVoxelsTouchItsSides) {
  for (const int first : {0, 1, 63, 64, 65, 128}) {
    VoxelMask set = empty_set();
    add_block(set, {first, 0, 0}, {200, 40, 40});
    const VoxelMask cropped = set.cropped();
    ASSERT_EQ(cropped.count(), set.count()) << first;
    const int x = set.low().x + first - cropped.low().x;
    const int y = set.low().y - cropped.low().y;
    EXPECT_GE(x, 1) << first;
    EXPECT_EQ(y, 1) << first;
    EXPECT_EQ(cropped.size().x, x + 200 - first + 1) << first;
    EXPECT_EQ(cropped.size().y, 42) << first;
    EXPECT_TRUE(cropped.contains(x, y, 0) && cropped.contains(x + 199 - first, y + 39, 39));
    EXPECT_FALSE(cropped.contains(x - 1, y, 0) || cropped.contains(x, y - 1, 0));
  }
}

/// Random voxels of that density, in a mask with several words a row.
VoxelMask noise(std::uint32_t seed, double density) {
  VoxelMask mask({-70, 3, 0}, {0, 3 + 14, 12});
  std::mt19937 random(seed);
  for (int z = 0; z < mask.size().z; ++z) {
    for (int y = 0; y < mask.size().y; ++y) {
      for (int x = 0; x < mask.size().x; ++x) {
        if (static_cast<double>(random()) < density * 4294967296.0) {
          add_block(mask, {x, y, z}, {x + 1, y + 1, z + 1});
        }
      }
    }
  }
  return mask;
}

using Label = std::vector<int>;  // indexed by x + size.x (y + size.y z); -1: not in the set

/// Connected components by a plain flood fill, numbered from 0.
/// @param max_steps  1: neighbours share a face; 2: a face or an edge
Label flood_fill(const VoxelMask& mask, bool of_gaps, int max_steps) {
  const Index3& size = mask.size();
  const auto index = [&](const Index3& p) {
    return static_cast<std::size_t>(p.x + size.x * (p.y + size.y * p.z));
  };
  Label labels(static_cast<std::size_t>(size.x * size.y * size.z), -1);
  const auto is_open = [&](const Index3& p) {
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < size.x && p.y < size.y && p.z < size.z &&
           mask.contains(p.x, p.y, p.z) != of_gaps && labels[index(p)] < 0;
  };
  int count = 0;
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    const Index3 start{i % size.x, i / size.x % size.y, i / size.x / size.y};
    if (!is_open(start)) {
      continue;
    }
    std::vector<Index3> open{start};
    labels[index(start)] = count;
    while (!open.empty()) {
      const Index3 p = open.back();
      open.pop_back();
      for (int step = 0; step < 27; ++step) {
        const int dx = step % 3 - 1;
        const int dy = step / 3 % 3 - 1;
        const int dz = step / 9 - 1;
        const Index3 q{p.x + dx, p.y + dy, p.z + dz};
        if (std::abs(dx) + std::abs(dy) + std::abs(dz) <= max_steps && is_open(q)) {
          labels[index(q)] = count;
          open.push_back(q);
        }
      }
    }
    ++count;
  }
  return labels;
}

template <typename Visit>
void for_each_voxel(const VoxelMask& mask, Visit visit) {
  std::size_t i = 0;
  for (int z = 0; z < mask.size().z; ++z) {
    for (int y = 0; y < mask.size().y; ++y) {
      for (int x = 0; x < mask.size().x; ++x) {
        visit(Index3{x, y, z}, i++);
      }
    }
  }
}

TEST(VoxelMask, FillsTheCavitiesThatAFloodFromOutsideDoesNotReach) {
  std::uint64_t filled = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const VoxelMask before = noise(seed, 0.5 + 0.05 * seed);
    const Label gaps = flood_fill(before, true, 2);
    std::set<int> outside;
    for_each_voxel(before, [&](const Index3& p, std::size_t i) {
      const Index3& size = before.size();
      if (p.x == 0 || p.y == 0 || p.z == 0 || p.x == size.x - 1 || p.y == size.y - 1 ||
          p.z == size.z - 1) {
        outside.insert(gaps[i]);
      }
    });
    VoxelMask after = before;
    after.fill_cavities();
    for_each_voxel(before, [&](const Index3& p, std::size_t i) {
      const bool expected = gaps[i] < 0 || !outside.contains(gaps[i]);
      ASSERT_EQ(after.contains(p.x, p.y, p.z), expected) << p.x << " " << p.y << " " << p.z;
    });
    filled += after.count() - before.count();
  }
  EXPECT_GT(filled, 20U);  // so that masks without cavities fail
}

/// A box of voxels, from `low` up to but not including `end`.
void set_box(VoxelMask& mask, const Index3& low, const Index3& end) {
  for (int z = low.z; z < end.z; ++z) {
    for (int y = low.y; y < end.y; ++y) {
      for (int x = low.x; x < end.x; ++x) {
        mask.row(y, z)[static_cast<std::size_t>(x) / 64] |= std::uint64_t{1} << (x % 64);
      }
    }
  }
}

TEST(VoxelMask, KeepsWhatStandsOnTheBaseBelowALargerThingButNotASpeck) {
  VoxelMask stands({0, 0, 0}, {16, 16, 16});
  set_box(stands, {1, 1, 0}, {7, 7, 4});
  set_box(stands, {1, 1, 8}, {9, 9, 16});
  keep_main_component(stands);
  EXPECT_EQ(stands.count(), 6U * 6 * 4);
  EXPECT_TRUE(stands.contains(3, 3, 0));

  VoxelMask hovers({0, 0, 0}, {16, 16, 16});
  set_box(hovers, {12, 12, 0}, {14, 14, 1});
  set_box(hovers, {1, 1, 1}, {9, 9, 9});
  keep_main_component(hovers);
  EXPECT_EQ(hovers.count(), 8U * 8 * 8);
}

TEST(VoxelMask, KeepsTheComponentThatAFloodFillFindsLargestWithTheBaseWeighed) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    VoxelMask before = noise(seed, 0.1 + 0.03 * seed);
    if (seed % 2 == 0) {  // nothing at the base: the largest component is kept
      for (int y = 0; y < before.size().y; ++y) {
        std::ranges::fill(before.row(y, 0), 0U);
      }
    }
    const Label labels = flood_fill(before, false, 1);
    const int count = *std::ranges::max_element(labels) + 1;
    std::vector<std::uint64_t> volumes(static_cast<std::size_t>(count));
    std::vector<bool> at_base(static_cast<std::size_t>(count));
    for_each_voxel(before, [&](const Index3& p, std::size_t i) {
      if (labels[i] >= 0) {
        const auto label = static_cast<std::size_t>(labels[i]);
        ++volumes[label];
        at_base[label] = at_base[label] || p.z == 0;
      }
    });
    EXPECT_EQ(before.component_count(), volumes.size());
    std::uint64_t most = 0;
    std::uint64_t largest = 0;
    bool stands = false;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      const std::uint64_t weighed = volumes[i] * (at_base[i] ? 8 : 1);
      if (weighed > most) {
        most = weighed;
        largest = volumes[i];
        stands = at_base[i];
      }
    }

    VoxelMask after = before;
    keep_main_component(after);

    EXPECT_EQ(after.count(), largest) << "seed " << seed;
    EXPECT_EQ(after.component_count(), 1U);
    std::set<int> kept;
    for_each_voxel(before, [&](const Index3& p, std::size_t i) {
      if (after.contains(p.x, p.y, p.z)) {
        kept.insert(labels[i]);
      }
    });
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_EQ(at_base[static_cast<std::size_t>(*kept.begin())], stands);
  }
}

}  // namespace
}  // namespace octurn
