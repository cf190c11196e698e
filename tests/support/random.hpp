#pragma once

#include <cstdint>
#include <random>

namespace octurn {

/// Random numbers that are the same everywhere. The standard specifies the bits of std::mt19937,
/// but its distributions differ from library to library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : bits_(seed) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits_()) / 4294967296.0; }

  bool chance(double probability) { return uniform() < probability; }

  /// A uniform integer in [low, high].
  int between(int low, int high) {
    return low + static_cast<int>(uniform() * (static_cast<double>(high) - low + 1));
  }

  /// Approximately normal with mean 0 and variance 1: the sum of twelve uniform numbers, of
  /// variance 1/12 each, minus 6.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
      sum += uniform();
    }
    return sum;
  }

 private:
  std::mt19937 bits_;
};

}  // namespace octurn
