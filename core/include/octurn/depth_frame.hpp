#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace octurn {

/// One image from a depth sensor.
struct DepthFrame {
  int width = 0;                          ///< pixels
  int height = 0;                         ///< pixels
  std::vector<std::uint16_t> depth = {};  ///< width x height, row by row from the top left, in the
                                          ///< sensor's depth unit; 0 is no reading
};

/// A pinhole depth camera. The defaults are a Kinect v1's nominal ones (field of view 58.1 x 45.3
/// degrees) with depth in tenths of a millimetre.
///
/// A sample (u, v) of value d lies at p = ((u - cx) z / fx, (v - cy) z / fy, z) with
/// z = d * depth_unit, in the optical frame: X right, Y down, Z forward, metres.
struct Intrinsics {
  int width = 640;    ///< pixels
  int height = 480;   ///< pixels
  double fx = 575.8;  ///< focal lengths, pixels
  double fy = 575.8;
  double cx = 320.0;  ///< principal point, pixels; (0, 0) is the middle of the top left sample
  double cy = 240.0;
  double depth_unit = 0.0001;  ///< metres

  bool operator==(const Intrinsics&) const = default;
};

/// How the frames of one still scene become one depth image (Bennett 2014, the three filters).
enum class DepthFilter {
  basic,            ///< the first frame, unchanged
  average,          ///< at each pixel the mean of the valid readings
  average_discard,  ///< the same, but a pixel without a reading in any frame has none
};

/// The filter's name in settings and files: "basic", "average", "average-discard".
std::string_view to_string(DepthFilter filter);

/// The filter of that name, if there is one.
std::optional<DepthFilter> depth_filter_named(std::string_view name);

/// Merges frames of one still scene into one depth image. Means are rounded to the nearest depth
/// unit, halves up.
///
/// @param frames  at least one, all of one size
/// @throws std::invalid_argument  if there is no frame, or the frames' sizes differ
DepthFrame merge_frames(std::span<const DepthFrame> frames, DepthFilter filter);

}  // namespace octurn
