#pragma once

#include "octurn/snapshot.hpp"

namespace octurn {

/// Crops a snapshot to the window of pixels whose rays may meet a box, with a margin for the
/// windows of conditioning. Returns the whole snapshot if no ray meets the box, or if the box
/// reaches up to the sensor.
///
/// @param snapshot  of a frame of the intrinsics' size
/// @param box       metres, object's frame
/// @throws std::invalid_argument  if the frame has another size
Snapshot crop(const Snapshot& snapshot, const Box& box);

}  // namespace octurn
