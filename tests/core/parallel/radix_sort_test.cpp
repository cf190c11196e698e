#include "parallel/radix_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace octurn {
namespace {

bool same(const std::vector<KeyIndex>& a, const std::vector<KeyIndex>& b) {
  return std::ranges::equal(a, b, [](const KeyIndex& left, const KeyIndex& right) {
    return left.key == right.key && left.index == right.index;
  });
}

/// Random keys, each with its position as its index.
std::vector<KeyIndex> random_keys(std::uint32_t count, std::uint32_t mask) {
  std::mt19937 random(count);
  std::vector<KeyIndex> keys;
  for (std::uint32_t i = 0; i < count; ++i) {
    keys.push_back({.key = static_cast<std::uint32_t>(random()) & mask, .index = i});
  }
  return keys;
}

TEST(RadixSort, IsAStableSortOfTheKeys) {
  for (const std::uint32_t mask : {0xffffffffU, 0xffffU, 0x7U}) {  // 0x7: many equal keys
    for (const std::uint32_t count : {0U, 1U, 2U, 100U, 10'000U}) {
      std::vector<KeyIndex> sorted = random_keys(count, mask);
      std::vector<KeyIndex> expected = sorted;
      std::ranges::stable_sort(expected, {}, &KeyIndex::key);
      radix_sort(sorted, 32);
      EXPECT_TRUE(same(sorted, expected)) << count << " keys of " << mask;
    }
  }
}

TEST(RadixSort, OrdersByTheLowestDigitsAlone) {
  // One digit has 11 bits: bit 11 and above must not matter.
  std::vector<KeyIndex> keys{{.key = 0x800U | 5U, .index = 0},
                             {.key = 0xfff000U | 3U, .index = 1},
                             {.key = 5U, .index = 2},
                             {.key = 3U, .index = 3}};
  radix_sort(keys, 11);
  EXPECT_TRUE(same(keys, {{.key = 0xfff000U | 3U, .index = 1},
                          {.key = 3U, .index = 3},
                          {.key = 0x800U | 5U, .index = 0},
                          {.key = 5U, .index = 2}}));
}

}  // namespace
}  // namespace octurn
