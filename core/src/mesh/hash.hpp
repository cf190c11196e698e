#pragma once

#include <cstdint>

namespace octurn {

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
inline std::uint64_t mix_bits(std::uint64_t bits) {
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111ebU;
  return bits ^ bits >> 31;
}

}  // namespace octurn
