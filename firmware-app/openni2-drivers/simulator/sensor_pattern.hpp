#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace octurn {

/// The fixed pattern error of a Kinect's readings: the lenses of its camera and its projector
/// differ from the factory's model. It is random and smooth, 0.8 readings (root mean square), and
/// correlated over some 50 pixels: in 107 real frames of tables the residuals of blocks of 16
/// pixels are 0.8 readings, and maps of two halves of the frames correlate by 0.996. A part of it
/// changes with distance: a map from one distance leaves two fifths at another.
class SensorPattern {
 public:
  /// @param share  factor of a real Kinect's error
  SensorPattern(std::uint32_t seed, double share);

  /// @param pixel          of 640 x 480, row by row
  /// @param inverse_depth  1/m
  /// @return the error to add to the reading
  float error(std::size_t pixel, float inverse_depth) const {
    return near_[pixel] + (inverse_depth - near_inverse_depth) * slope_[pixel];
  }

 private:
  static constexpr float near_inverse_depth = 1 / 0.65F;

  std::vector<float> near_;   // readings
  std::vector<float> slope_;  // readings for each 1/m
};

}  // namespace octurn
