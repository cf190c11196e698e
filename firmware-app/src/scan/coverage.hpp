#pragma once

#include <cstddef>
#include <string>

#include "octurn/snapshot.hpp"

namespace octurn {

/// The number of pixels that have a depth.
std::ptrdiff_t readings_in(const DepthFrame& frame);

/// A sensor that is well sees about as much at every stop: what turns is a part of the picture.
/// @param readings  at a stop
/// @param first     at the scan's first stop
/// @param sensor    its name
/// @throws Error "sensor-blind"  if there are none, or far fewer
void expect_coverage(std::ptrdiff_t readings, std::ptrdiff_t first, const std::string& sensor);

}  // namespace octurn
