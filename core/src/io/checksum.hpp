#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace octurn {

/// Detects accidental changes of bytes, but not forgery: FNV-1a (Fowler, Noll and Vo 1991), 64
/// bits.
class Checksum {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      value_ = (value_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3U;
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace octurn
