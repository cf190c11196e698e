#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace octurn {

/// Random numbers over the picture, close to normally distributed with mean 0 and variance 1. They
/// are correlated as a Kinect's errors are: it correlates windows of about 9 x 3 pixels, and
/// neighbours share most of their windows.
///
/// The field is larger than the picture, so that every frame can look at another part of it.
class NoiseField {
 public:
  explicit NoiseField(std::uint32_t seed);

  /// One row of a picture that looks at part `part` of the field, `width` = 640 values in units of
  /// 1/`one`. Parts are drawn at random: any two of them share few places, or none.
  std::span<const std::int8_t> row(std::uint32_t part, int v) const;

  static constexpr float one = 25.0F;

 private:
  static constexpr int width = 1024;
  static constexpr int height = 512;
  std::vector<std::int8_t> values_;
};

/// A well mixed number for each pair, to draw parts by (the finaliser of Murmur3).
std::uint32_t mixed(std::uint32_t seed, std::uint32_t number);

}  // namespace octurn
