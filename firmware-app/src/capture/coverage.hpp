#pragma once

#include <cstddef>
#include <string>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Returns the number of pixels with a depth.
std::ptrdiff_t readings_in(const DepthFrame& frame);

/// Checks that a stop has about as many readings as the first one: only a part of the picture
/// turns.
/// @param readings  at this stop
/// @param first     at the scan's first stop
/// @param sensor    name, for the message
/// @throws Error "sensor-blind"  if there are none, or far fewer than at the first stop
void expect_coverage(std::ptrdiff_t readings, std::ptrdiff_t first, const std::string& sensor);

}  // namespace octurn
