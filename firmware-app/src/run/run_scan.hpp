#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "store/job.hpp"

namespace octurn {

/// Takes a turn of snapshots into a scan folder, and builds `folder/Scan.stl` from them.
///
/// Each snapshot is on the disk before the platform moves on. Depth images are added to the
/// reconstruction while the platform turns; laser lines only after the turn, because the first
/// stop's surface ends at the last stop's lines. Stored snapshots are kept however the scan ends. A
/// folder with some snapshots is continued, and gives the same model as an uninterrupted scan.
///
/// Unless the settings say `configured`, the sensor's pose is solved from the snapshots at the last
/// stop. A pose that is accepted and does not merely confirm the configured one is stored beside it
/// in scan.json, and the model is built again from the stored snapshots. For the preview alone, it
/// is solved once after a third of the turn as well.
///
/// With a depth sensor, the platform turns on after the last stop to the first one's angle for one
/// more depth image, the last look. It is not part of the model; it measures how the object moved,
/// for scan.json and the verdict.
///
/// @return the model; nullopt if stopped first
/// @throws Error  if the sensor, the turntable or the disk fails, or there is no surface
std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Rig& rig,
                              const std::stop_token& stop, const ScanObserver& observer);

}  // namespace octurn
