#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Takes the last look: turns the platform on to the first stop's angle and takes one more depth
/// image there. It shows whether the object moved during the turn, and is not part of the model. A
/// device's failure is logged, and does not fail the scan.
/// @return nullopt if a device failed, or stopped first
std::optional<DepthFrame> retake_first_stop(Rig& rig, const ScanSettings& settings,
                                            const std::stop_token& stop,
                                            const ScanObserver& observer);

/// Measures the object's motion between the first snapshot of a stored scan and that image, and
/// writes the result into its scan.json. An error is logged.
void store_object_motion(const std::filesystem::path& folder, const DepthFrame& again);

/// Adds the finding of a stored scan's last look, if it has one.
/// @throws Error  as `read_scan`
void add_stored_move(const std::filesystem::path& folder,
                     std::vector<CalibrationFinding>& findings);

}  // namespace octurn
