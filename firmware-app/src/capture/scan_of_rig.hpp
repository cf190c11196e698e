#pragma once

#include <algorithm>
#include <optional>

#include "capture/rig.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// Returns the part of a new scan by laser line that is known before a device is opened: camera and
/// lasers.
Scan scan_of_lasers(const Rig& rig, const ScanSettings& settings);

/// The sensor's intrinsics for a scan. Known optics have the scale themselves.
Intrinsics to_intrinsics(const DepthSensor& sensor, bool knows_optics,
                         const ScanSettings& settings);

/// Returns the options of a scan's model.
/// @param scan  as above, or with the snapshots so far
ReconstructOptions options_of_scan(const Scan& scan, const ScanSettings& settings,
                                   const Limits& limits);

/// Returns the part of a new scan by depth sensor that all its snapshots share. It has no map.
Scan scan_of_sensor(Rig& rig, const ScanSettings& settings);

/// Returns intrinsics with a scaled depth unit. `scan.json` stores the product as `depth_unit_m`,
/// so that readers of a stored scan need no scale.
inline Intrinsics scaled(Intrinsics lens, double depth_scale) {
  lens.depth_unit *= depth_scale;
  return lens;
}

/// The same of known optics, which have the scale in place of the depth unit.
inline SolvedOptics scaled(SolvedOptics optics, double depth_scale) {
  optics.value.depth_scale *= depth_scale;
  return optics;
}

/// Returns the relative sigma of a scan's depths. A factor other than 1 comes from a length that
/// was measured with calipers, and on a model: each to 0.1 mm, of 100 mm. Known optics have a sigma
/// of their own, which is smaller if a board gave them.
inline double scale_sigma(double depth_scale, const std::optional<SolvedOptics>& optics) {
  constexpr double of_a_known_length = 0.0015;
  if (depth_scale != 1) {
    return of_a_known_length;
  }
  const double known = optics ? optics->sigma.depth_scale : 0;
  return known > 0 ? std::min(known, unknown_scale_sigma) : unknown_scale_sigma;
}

}  // namespace octurn
