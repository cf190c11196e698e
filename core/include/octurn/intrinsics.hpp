#pragma once

namespace octurn {

/// A pinhole depth camera. The defaults are a Kinect v1's nominal ones (field of view 58.1 x 45.3
/// degrees) with depth in tenths of a millimetre.
///
/// A sample (u, v) of value d lies at p = ((u - cx) z / fx, (v - cy) z / fy, z) with
/// z = d * depth_unit, in the optical frame: X right, Y down, Z forward.
struct Intrinsics {
  int width = 640;  // pixels
  int height = 480;
  double fx = 575.8;  // pixels
  double fy = 575.8;
  double cx = 320.0;
  double cy = 240.0;
  double depth_unit = 0.0001;  // metres

  bool operator==(const Intrinsics&) const = default;
};

}  // namespace octurn
