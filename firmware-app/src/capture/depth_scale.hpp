#pragma once

#include "octurn/snapshot.hpp"

namespace octurn {

/// Returns intrinsics with a scaled depth unit. `scan.json` stores the product as `depth_unit_m`,
/// so that readers of a stored scan need no scale.
inline Intrinsics scaled(Intrinsics lens, double depth_scale) {
  lens.depth_unit *= depth_scale;
  return lens;
}

}  // namespace octurn
