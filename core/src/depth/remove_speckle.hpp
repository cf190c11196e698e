#pragma once

#include "depth/depth_image.hpp"

namespace octurn {

/// Drops readings without support: those with fewer than five of the nine readings in their 3 x 3
/// window, themselves included, within `depth_step_limit`. The image's border is dropped, too.
DepthImage remove_speckle(const DepthImage& image);

}  // namespace octurn
