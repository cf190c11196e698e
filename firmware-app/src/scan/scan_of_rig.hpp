#pragma once

#include <filesystem>

#include "octurn/scan_folder.hpp"
#include "scan/rig.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

/// The part of a new scan that is known before a device is opened: camera and lasers of a laser
/// rig; nothing for a depth sensor.
Scan scan_of_rig(const Rig& rig, const ScanSettings& settings);

/// The options of a scan's model. @param scan  as above, or with the snapshots that it has so far
ReconstructOptions options_of_scan(const Scan& scan, const ScanSettings& settings,
                                   const Limits& limits);

/// Completes a new scan by the data that all its snapshots share.
/// @param folder  of the scan, which may have a sensor map
void begin_scan(Scan& scan, const ScanSettings& settings, const std::filesystem::path& folder,
                Rig& rig);

/// Whether a scan was made with the rig's kind of sensor, or with its camera and lasers. The
/// lasers' planes may have been measured since: a scan has those that it was begun with.
bool has_sensor_of(const Scan& scan, const ScanSettings& settings, Rig& rig);

/// Whether a scan that was begun can go on with this rig.
/// @throws Error "sensor-other"
void expect_same_rig(const Scan& scan, const ScanSettings& settings, Rig& rig);

}  // namespace octurn
