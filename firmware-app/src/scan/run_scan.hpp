#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "scan/job.hpp"
#include "scan/rig.hpp"
#include "scan/scan_observer.hpp"

namespace octurn {

/// Takes a turn of snapshots into a scan folder, and builds `folder/Scan.stl` from them.
///
/// Each snapshot is on the disk before the platform moves on, and is added to the reconstruction
/// while the platform turns. Stored snapshots are kept however the scan ends. A folder with some
/// snapshots is continued, and gives the same model as an uninterrupted scan.
///
/// Unless the settings say `told`, the sensor's pose is solved from the snapshots at the last stop.
/// A pose that is accepted and does not merely confirm the told one is stored beside it in
/// scan.json, and the model is built again from the stored snapshots.
///
/// After the last stop the platform turns on to the first one's angle for one more depth image, the
/// last look. It is in no model: scan.json and the verdict tell how the object moved meanwhile.
///
/// @return the model, or nothing if stopped first
/// @throws Error  if the sensor, the turntable or the disk fails, or there is no surface
std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Rig& rig,
                              const std::stop_token& stop, const ScanObserver& observer);

}  // namespace octurn
