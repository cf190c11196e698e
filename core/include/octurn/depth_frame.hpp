#pragma once

#include <cstdint>
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

}  // namespace octurn
