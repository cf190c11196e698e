#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "scan/rig.hpp"
#include "scan/scan_observer.hpp"

namespace octurn {

/// A stop of the platform.
struct Stop {
  int index = 0;              ///< counted from 0
  std::int64_t position = 0;  ///< of the turntable, microsteps
};

/// Turns to a stop, and tells it.
/// @return false if stopped first
/// @throws Error "turntable-..."
bool turn_to(Rig& rig, const Stop& at, const std::stop_token& stop, const ScanObserver& observer);

/// Turns to a stop and takes its depth image: the filter's of the frames that the settings ask for,
/// each exposed after the platform stood still.
///
/// @return nothing if stopped first
/// @throws Error "sensor-...", "turntable-..."
std::optional<DepthFrame> take_depth_image(Rig& rig, const Stop& at, const ScanSettings& settings,
                                           const std::stop_token& stop,
                                           const ScanObserver& observer);

}  // namespace octurn
