#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace octurn {

/// What a real Kinect reads wrong at each pixel, and always: the lenses of its camera and its
/// projector are not those of the factory's model. Random and smooth, 0.8 readings (root mean
/// square) that are alike up to some 50 pixels away: in 107 real frames of tables the residuals of
/// blocks of 16 pixels are 0.8 readings, and maps of two halves of the frames correlate by 0.996. A
/// part of it changes with distance: a map from one distance leaves two fifths at another.
class SensorPattern {
 public:
  /// @param share  times a real Kinect's
  SensorPattern(std::uint32_t seed, double share);

  /// @param pixel          of 640 x 480, row by row
  /// @param inverse_depth  1/m
  /// @return what is added to the reading there
  float error(std::size_t pixel, float inverse_depth) const {
    return near_[pixel] + (inverse_depth - near_inverse_depth) * slope_[pixel];
  }

 private:
  static constexpr float near_inverse_depth = 1 / 0.65F;

  std::vector<float> near_;   // readings
  std::vector<float> slope_;  // readings for each 1/m
};

}  // namespace octurn
