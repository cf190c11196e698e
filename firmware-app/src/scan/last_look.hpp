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

/// Turns on to the angle of the first stop, and takes one more depth image there: it is in no
/// model. Where a device fails the log says so, as no scan is lost for it.
/// @return nothing if a device failed, or stopped first
std::optional<DepthFrame> look_again(Rig& rig, const ScanSettings& settings,
                                     const std::stop_token& stop, const ScanObserver& observer);

/// Compares that image with the first snapshot of a stored scan, and writes into its scan.json how
/// the object moved. Where that fails the log says so.
void keep_move(const std::filesystem::path& folder, const DepthFrame& again);

/// Adds what the last look at a stored scan tells, if there was one.
/// @throws Error  as `read_scan`
void add_stored_move(const std::filesystem::path& folder,
                     std::vector<CalibrationFinding>& findings);

}  // namespace octurn
