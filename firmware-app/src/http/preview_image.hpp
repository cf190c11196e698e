#pragma once

#include <string>

#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A depth frame as a picture for people: PNG, 8-bit grey, 320 x 240, near bright, far dark, black
/// where there is no reading.
std::string preview_png(const DepthFrame& frame, double depth_unit);

/// A camera's picture as PNG of that size, with unchanged brightness.
std::string preview_png(const Picture& picture);

}  // namespace octurn
