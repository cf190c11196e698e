#pragma once

#include "octurn/snapshot.hpp"

namespace octurn {

/// Returns intrinsics with a scaled depth unit. `scan.json` stores the product as `depth_unit_m`,
/// so that readers of a stored scan need no scale.
inline Intrinsics scaled(Intrinsics lens, double depth_scale) {
  lens.depth_unit *= depth_scale;
  return lens;
}

/// The same of known optics, which have the scale in place of the depth unit.
inline SensorOptics scaled(SensorOptics optics, double depth_scale) {
  optics.depth_scale *= depth_scale;
  return optics;
}

}  // namespace octurn
