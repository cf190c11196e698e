#pragma once

#include "octurn/box.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The part of a snapshot whose rays may meet a box, with some pixels around it that conditioning
/// looks at; all of it, if no part does, or the box reaches up to the sensor.
///
/// @param snapshot  its frame has the intrinsics' size
/// @param box       metres, platform frame
/// @throws std::invalid_argument  if the frame has another size
Snapshot crop(const Snapshot& snapshot, const Box& box);

}  // namespace octurn
