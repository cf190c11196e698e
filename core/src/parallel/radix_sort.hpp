#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace octurn {

struct KeyIndex {
  std::uint32_t key;
  std::uint32_t index;
};

/// Sorts by the lowest bits of the keys, some at a time; what has these in common stays in order.
inline void radix_sort(std::vector<KeyIndex>& places, int bits) {
  constexpr int digit_bits = 11;
  constexpr std::uint32_t digits = 1U << digit_bits;
  std::vector<KeyIndex> sorted(places.size());
  for (int shift = 0; shift < bits; shift += digit_bits) {
    std::array<std::uint32_t, digits + 1> next{};
    for (const KeyIndex& place : places) {
      ++next[(place.key >> shift) % digits + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const KeyIndex& place : places) {
      sorted[next[(place.key >> shift) % digits]++] = place;
    }
    places.swap(sorted);
  }
}

}  // namespace octurn
