#pragma once

#include "octurn/json_object.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

// Bounds of a lens in a file from elsewhere. They are wider than any camera, and so narrow that
// coordinates of pixels stay finite as float: conversions to int rely on that.
inline constexpr int max_image_side = 8192;     // pixels; no sensor's image is larger
inline constexpr double min_focal = 1;          // pixels; wider than 89 degrees to each side
inline constexpr double max_focal = 100'000;    // pixels
inline constexpr double min_depth_unit = 1e-9;  // metres
inline constexpr double max_depth_unit = 1;     // metres
inline constexpr double max_distortion = 100;   // of k1 and k2: wider than any lens

/// Reads a pinhole lens from the keys fx, fy, cx and cy. Width, height and depth unit keep their
/// defaults. @throws Error  that names a key out of its bounds
Intrinsics lens_from(JsonObject& keys);

/// Reads the key depth_unit_m. @throws Error  as above
double depth_unit_from(JsonObject& keys);

}  // namespace octurn
