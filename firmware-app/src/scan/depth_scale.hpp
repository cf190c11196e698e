#pragma once

#include "octurn/snapshot.hpp"

namespace octurn {

/// A sensor's intrinsics with its depths scaled: `scan.json` keeps the product as `depth_unit_m`,
/// so that a stored scan needs to know of no scale.
inline Intrinsics scaled(Intrinsics lens, double depth_scale) {
  lens.depth_unit *= depth_scale;
  return lens;
}

}  // namespace octurn
