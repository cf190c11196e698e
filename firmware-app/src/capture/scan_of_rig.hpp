#pragma once

#include <filesystem>

#include "capture/rig.hpp"
#include "octurn/scan_folder.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// Returns the part of a new scan that is known before a device is opened: camera and lasers of a
/// rig with lasers; an empty scan for a depth sensor.
Scan scan_of_rig(const Rig& rig, const ScanSettings& settings);

/// Returns the options of a scan's model.
/// @param scan  as above, or with the snapshots so far
ReconstructOptions options_of_scan(const Scan& scan, const ScanSettings& settings,
                                   const Limits& limits);

/// Returns the part of a new scan by depth sensor that all its snapshots share. It has no map.
Scan scan_of_sensor(Rig& rig, const ScanSettings& settings);

/// Completes a new scan with the data that all its snapshots share.
/// @param folder  the scan's, which may contain a sensor map
void begin_scan(Scan& scan, const ScanSettings& settings, const std::filesystem::path& folder,
                Rig& rig);

/// Whether a scan has the intrinsics of the rig's sensor, or the lens and lasers of its camera.
/// Planes of lasers are not compared: they may have been measured since the scan began.
bool has_sensor_of(const Scan& scan, const ScanSettings& settings, Rig& rig);

/// Checks that a scan can be continued with this rig.
/// @throws Error "sensor-other"
void expect_same_rig(const Scan& scan, const ScanSettings& settings, Rig& rig);

}  // namespace octurn
