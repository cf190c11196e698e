#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"

namespace octurn {

/// A stop of the platform.
struct Stop {
  int index = 0;              ///< counted from 0
  std::int64_t position = 0;  ///< of the turntable, microsteps
};

/// Turns the platform to a stop, and reports progress and angle to the observer.
/// @return false if stopped first
/// @throws Error "turntable-..."
bool turn_to(Rig& rig, const Stop& at, const std::stop_token& stop, const ScanObserver& observer);

/// Turns the platform to a stop and takes its depth image: frames, exposed after the platform stood
/// still, are merged by the settings' filter.
///
/// @return nullopt if stopped first
/// @throws Error "sensor-...", "turntable-..."
std::optional<DepthFrame> take_depth_image(Rig& rig, const Stop& at, const ScanSettings& settings,
                                           const std::stop_token& stop,
                                           const ScanObserver& observer);

}  // namespace octurn
