#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace octurn {

/// Independent random numbers, close to normally distributed with mean 0 and variance 1.
class WhiteNoise {
 public:
  explicit WhiteNoise(std::uint32_t seed);

  /// The number at a place of a sequence. All sequences are parts of one table.
  /// @param sequence  a random number, which determines where in the table the sequence starts
  /// @param place     below 8192
  float at(std::uint32_t sequence, std::size_t place) const {
    return values_[((sequence * std::size_t{7919}) + place) % values_.size()];
  }

 private:
  std::vector<float> values_;
};

}  // namespace octurn
