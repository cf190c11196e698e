#include "capture/scan_of_rig.hpp"

#include <cstddef>
#include <system_error>

#include "octurn/error.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

/// The sensor's intrinsics for a scan. Known optics have the scale themselves.
Intrinsics to_intrinsics(DepthSensor& sensor, bool knows_optics, const ScanSettings& settings) {
  return knows_optics ? sensor.intrinsics() : scaled(sensor.intrinsics(), settings.depth_scale);
}

}  // namespace

Scan scan_of_rig(const Rig& rig, const ScanSettings& settings) {
  const LaserSettings* const configured = rig.laser();
  return configured == nullptr ? Scan{}
                               : Scan{.intrinsics = configured->lens,
                                      .laser = laser_camera(*configured),
                                      .platform_from_sensor = configured->platform_from_sensor,
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

void begin_scan(Scan& scan, const ScanSettings& settings, const std::filesystem::path& folder,
                Rig& rig) {
  std::error_code ignored;  // if the folder cannot be made, the first image says why
  std::filesystem::create_directories(folder, ignored);
  if (scan.laser) {
    scan.sensor_name = rig.camera().name();
    scan.sensor_serial = rig.camera().serial();
    return;
  }
  scan = scan_of_sensor(rig, settings);
  if (const auto map = folder / sensor_map_file; std::filesystem::exists(map)) {
    use_sensor_map(scan, map);
  }
}

bool has_sensor_of(const Scan& scan, const ScanSettings& settings, Rig& rig) {
  Scan of_rig = scan_of_rig(rig, settings);
  if (!of_rig.laser) {
    of_rig.intrinsics = to_intrinsics(rig.sensor(), scan.optics.has_value(), settings);
  }
  return have_same_sensor(of_rig, scan);
}

void expect_same_rig(const Scan& scan, const ScanSettings& settings, Rig& rig) {
  if (!has_sensor_of(scan, settings, rig)) {
    throw Error(ErrorCode::sensor_other,
                "this scan was begun with another sensor: " + scan.sensor_name,
                "Plug in the one that it was begun with.", {{"begun_with", scan.sensor_name}});
  }
}

}  // namespace octurn
