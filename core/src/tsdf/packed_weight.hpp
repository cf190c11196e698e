#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace octurn {

/// A sum of weights in 16 bits: a floating-point number of five bits of exponent and eleven of
/// mantissa, from 2^-16 to 2^16, or 0.
///
/// No scan reaches the maximum, and every sum is rounded to 1/4096 of itself. The weighted mean
/// therefore does not depend on the sensor's distance and, except for rounding, not on the order of
/// the snapshots.
using PackedWeight = std::uint16_t;

namespace packed_weight {
inline constexpr int dropped_bits = 12;                      // of a float's mantissa
inline constexpr std::uint32_t smallest = (127 - 16) << 11;  // 2^-16 without those bits
}  // namespace packed_weight

constexpr float unpack(PackedWeight weight) {
  const std::uint32_t bits = (weight + packed_weight::smallest) << packed_weight::dropped_bits;
  return weight == 0 ? 0.0F : std::bit_cast<float>(bits);
}

/// @param weight  at least 0
constexpr PackedWeight pack(float weight) {
  constexpr std::uint32_t half = 1U << (packed_weight::dropped_bits - 1);
  const std::uint32_t bits =
      (std::bit_cast<std::uint32_t>(weight) + half) >> packed_weight::dropped_bits;
  return static_cast<PackedWeight>(
      std::clamp(bits, packed_weight::smallest, packed_weight::smallest + 0xffffU) -
      packed_weight::smallest);
}

}  // namespace octurn
