#include "voxel/voxel_mask.hpp"

#include <gtest/gtest.h>

namespace octurn {
namespace {

/// Adds the leaves from `low` up to but without `end`, counted from the box's lowest corner.
void add_block(VoxelMask& set, const Index3& low, const Index3& end) {
  for (int z = low.z; z < end.z; ++z) {
    for (int y = low.y; y < end.y; ++y) {
      for (int x = low.x; x < end.x; ++x) {
        set.row(y, z)[static_cast<std::size_t>(x) / 64] |= std::uint64_t{1} << (x % 64);
      }
    }
  }
}

/// Empty, of more than one word a row, and not at the lattice's origin.
VoxelMask empty_set() { return VoxelMask({16, 32, 8}, {16 + 200, 32 + 40, 8 + 40}); }

TEST(VoxelMask, RemovesANeedleInAnyDirection) {
  VoxelMask set = empty_set();
  add_block(set, {60, 10, 0}, {70, 20, 10});
  const std::uint64_t block = set.count();
  add_block(set, {70, 15, 5}, {150, 16, 6});  // through the words of a row
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
  add_block(set, {5, 5, 0}, {100, 6, 30});  // one leaf thick
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

TEST(VoxelMask, HoldsTheSameLeavesWhenCropped) {
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

}  // namespace
}  // namespace octurn
