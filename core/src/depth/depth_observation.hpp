#pragma once

#include <array>

namespace octurn {

/// What one pixel of a conditioned depth image observes, in the sensor's optical frame, metres.
struct DepthObservation {
  std::array<float, 3> normal = {};  // of the surface's tangent plane, towards the sensor
  float offset = 0;                  // signed distance to that plane is normal . point + offset
  float weight = 0;                  // of the surface; 0: none was observed
  float free_space_depth = 0;        // z up to which the ray is free; 0: unknown
};

}  // namespace octurn
