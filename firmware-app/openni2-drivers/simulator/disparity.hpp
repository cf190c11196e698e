#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// The depth scale of a Kinect v1: an 11-bit reading that is affine in inverse depth,
/// z = 345489 / (1089.40 - reading) mm. The constants fit 510 of the 512 distinct depths in 110
/// frames of real sensors. 345489 mm is 8 f b: eighths of a pixel, f = 575.8 pixels, b = 75 mm.
inline constexpr float reading_at_infinity = 1089.40F;
inline constexpr float readings_times_metres = 345.489F;

/// The reading of a pixel without depth.
inline constexpr int no_reading = 2047;

/// @param inverse_depth  1/m  @return the reading before it is rounded
constexpr float to_reading(float inverse_depth) {
  return reading_at_infinity - readings_times_metres * inverse_depth;
}

/// The depth of each of the 2048 readings, tenths of a millimetre; 0 for those nearer than the
/// sensor's limit (0.45 m), farther than 16 bits of tenths of a millimetre reach, or no reading.
std::vector<std::uint16_t> depth_of_readings();

}  // namespace octurn
