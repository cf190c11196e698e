#pragma once

#include <filesystem>
#include <stop_token>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Turns a rig with lasers to a stop and takes its pictures into a scan folder. Each is written
/// while the next one is taken; all of them, and the scan.json that names them, are on the disk
/// when this returns.
///
/// @param angle  of the platform there, radians
/// @return false if stopped first
/// @throws Error  as `take_pictures`, and "disk-full", "write-failed"
bool take_stop(Rig& rig, const Stop& at, double angle, const std::filesystem::path& folder,
               Scan& scan, const std::stop_token& stop, const ScanObserver& observer);

}  // namespace octurn
