#include "capture/scan_of_rig.hpp"

#include <cstddef>

#include "store/stored_scan.hpp"

namespace octurn {
Intrinsics to_intrinsics(const DepthSensor& sensor, bool knows_optics,
                         const ScanSettings& settings) {
  return knows_optics ? sensor.intrinsics() : scaled(sensor.intrinsics(), settings.depth_scale);
}

Scan scan_of_lasers(const Rig& rig, const ScanSettings& settings) {
  const LaserSettings& configured = *rig.laser();
  return {.intrinsics = configured.lens,
          .laser = laser_camera(configured),
          .platform_from_sensor = configured.platform_from_sensor,
          .clip = settings.clip};
}

ReconstructOptions options_of_scan(const Scan& scan, const ScanSettings& settings,
                                   const Limits& limits) {
  const auto snapshots = static_cast<std::size_t>(settings.snapshots);
  ReconstructOptions options = checked_options(settings, limits, snapshots);
  if (!scan.shots.empty()) {
    options.clip = scan.clip;  // exact: a resumed scan's settings were stored in millimetres
  }
  Scan whole = scan;
  whole.shots.resize(snapshots);
  fit_to_scan(options, whole);
  return options;
}

Scan scan_of_sensor(Rig& rig, const ScanSettings& settings) {
  return {.sensor_name = rig.sensor().name(),
          .sensor_serial = rig.sensor().serial(),
          .intrinsics = to_intrinsics(rig.sensor(), rig.optics().has_value(), settings),
          .optics = rig.optics(),
          .scale_sigma = scale_sigma(settings.depth_scale, rig.optics()),
          .sensor_on_for = rig.sensor_on_for(),
          .platform_from_sensor = settings.platform_from_sensor,
          .clip = settings.clip};
}

}  // namespace octurn
