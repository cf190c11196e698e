#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace octurn {

/// A sort key, and the index of its item.
struct KeyIndex {
  std::uint32_t key;
  std::uint32_t index;
};

/// Sorts by the lowest `bits` of the keys. Stable. LSD radix sort, O(n bits / 11).
inline void radix_sort(std::vector<KeyIndex>& keys, int bits) {
  constexpr int digit_bits = 11;
  constexpr std::uint32_t digits = 1U << digit_bits;
  std::vector<KeyIndex> sorted(keys.size());
  for (int shift = 0; shift < bits; shift += digit_bits) {
    std::array<std::uint32_t, digits + 1> next{};
    for (const KeyIndex& key : keys) {
      ++next[(key.key >> shift) % digits + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const KeyIndex& key : keys) {
      sorted[next[(key.key >> shift) % digits]++] = key;
    }
    keys.swap(sorted);
  }
}

}  // namespace octurn
