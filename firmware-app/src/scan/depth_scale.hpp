#pragma once

#include "octurn/snapshot.hpp"

namespace octurn {

/// A sensor's intrinsics with its depth unit scaled. `scan.json` keeps the product as
/// `depth_unit_m`, so that a stored scan is read without the scale.
inline Intrinsics scaled(Intrinsics lens, double depth_scale) {
  lens.depth_unit *= depth_scale;
  return lens;
}

}  // namespace octurn
