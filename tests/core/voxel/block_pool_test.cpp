#include "voxel/block_pool.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octurn {
namespace {

constexpr std::uint32_t items_per_block = BlockPool<int>::block_items;

TEST(BlockPool, CountsFromOneAsZeroMeansNone) {
  BlockPool<int> pool;
  EXPECT_EQ(pool.add(), 1U);
  EXPECT_EQ(pool.add(), 2U);
}

TEST(BlockPool, NeverMovesAnItem) {
  BlockPool<int> pool;
  const std::uint32_t first = pool.add();
  const int* const address = &pool[first];
  pool[first] = 7;
  for (std::uint32_t i = 0; i < 3 * items_per_block; ++i) {
    pool[pool.add()] = -1;
  }
  EXPECT_EQ(&pool[first], address);
  EXPECT_EQ(pool[first], 7);
}

TEST(BlockPool, SaysBeforeItTakesABlockThatItWill) {
  BlockPool<int> pool;
  for (std::uint32_t i = 0; i < 3 * items_per_block; ++i) {
    const bool was_full = pool.is_full();
    const std::size_t before = pool.bytes();
    pool.add();
    EXPECT_EQ(pool.bytes() - before, was_full ? pool.block_bytes : 0U) << i;
  }
}

TEST(BlockPool, GivesARemovedItemOutAgainAsNew) {
  BlockPool<int> pool;
  std::vector<std::uint32_t> indices;
  while (!pool.is_full()) {
    indices.push_back(pool.add());
    pool[indices.back()] = 7;
  }
  pool.remove(indices[10]);
  EXPECT_FALSE(pool.is_full());
  const std::uint32_t again = pool.add();
  EXPECT_EQ(again, indices[10]);
  EXPECT_EQ(pool[again], 0);
  EXPECT_EQ(pool[indices[11]], 7);
  EXPECT_TRUE(pool.is_full());
}

}  // namespace
}  // namespace octurn
