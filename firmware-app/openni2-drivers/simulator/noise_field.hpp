#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace octurn {

/// Random numbers over the picture, close to normally distributed with mean 0 and variance 1. They
/// are spatially correlated like a Kinect's errors: a Kinect matches windows of about 9 x 3 pixels,
/// and the windows of neighbours overlap.
///
/// The field is larger than the picture, so that every frame can use another part of it.
class NoiseField {
 public:
  explicit NoiseField(std::uint32_t seed);

  /// Row `v` of part `part` of the field: 640 values in units of 1/`one`. Parts drawn at random
  /// rarely coincide: a pixel gets another value in each.
  std::span<const std::int8_t> row(std::uint32_t part, int v) const;

  static constexpr float one = 25.0F;

 private:
  static constexpr int width = 1024;
  static constexpr int height = 512;
  std::vector<std::int8_t> values_;
};

/// Hashes a pair of numbers by the finaliser of MurmurHash3; for random numbers.
std::uint32_t mixed(std::uint32_t seed, std::uint32_t number);

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
