#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/snapshot.hpp"
#include "scan/rig.hpp"
#include "scan/scan_observer.hpp"

namespace octurn {

/// Turns on to the angle of the first stop, and takes one more depth image there, which is in no
/// model. A device that fails is logged, and does not fail the scan.
/// @return nothing if a device failed, or stopped first
std::optional<DepthFrame> look_again(Rig& rig, const ScanSettings& settings,
                                     const std::stop_token& stop, const ScanObserver& observer);

/// Measures how the object moved from the first snapshot of a stored scan to that image, and writes
/// the result into its scan.json. An error is logged.
void keep_move(const std::filesystem::path& folder, const DepthFrame& again);

/// Adds the finding of a stored scan's last look, if it has one.
/// @throws Error  as `read_scan`
void add_stored_move(const std::filesystem::path& folder,
                     std::vector<CalibrationFinding>& findings);

}  // namespace octurn
