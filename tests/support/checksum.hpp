#pragma once

#include <cstdint>
#include <string_view>

namespace octurn {

/// A 64-bit FNV-1a hash (Fowler, Noll and Vo), to compare bytes without keeping them.
class Checksum {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) {
      sum_ = (sum_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
    }
    bytes_ += bytes.size();
  }

  std::uint64_t bytes() const { return bytes_; }
  friend bool operator==(const Checksum&, const Checksum&) = default;
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325U;
  std::uint64_t bytes_ = 0;
};

}  // namespace octurn
