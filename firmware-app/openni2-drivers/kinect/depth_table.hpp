#pragma once

#include <array>
#include <cstdint>

namespace octurn {

/// Calibration of one Kinect v1, written into it by the factory. The defaults are typical.
struct KinectParameters {
  double baseline_cm = 7.5;            ///< from the projector to the depth camera
  double reference_distance_cm = 120;  ///< of the plane of the stored reference pattern
  double reference_pixel_cm = 0.1042;  ///< width on that plane of one pixel of 1280 x 960
  double shift = 200;                  ///< offset of readings, which makes them positive

  /// The depth camera's, in pixels of 640 x 480.
  double focal_length() const { return reference_distance_cm / (2 * reference_pixel_cm); }
};

/// The 11-bit reading of a pixel without depth.
inline constexpr int no_kinect_reading = 2047;

/// The depth of each of the 2048 readings, rounded to tenths of a millimetre. It is 0 for
/// `no_kinect_reading`, for readings beyond infinity, and for depths that 16 bits cannot hold.
using DepthTable = std::array<std::uint16_t, no_kinect_reading + 1>;

/// Computes the depth of each reading. With the metric shift m = ((reading - 4 shift) / 4 - 3/8) p,
/// it is
/// z = 10 (m d / (b - m) + d) mm: baseline b, reference distance d, reference pixel p. For the
/// defaults it is z = 345489 / (1089.40 - reading) mm, which fits frames of real sensors.
DepthTable depth_table(const KinectParameters& parameters);

}  // namespace octurn
