#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "capture/platform_swing.hpp"
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

using OnFrame = std::function<void(const DepthFrame& frame)>;

/// Reads frames of a platform that stands still: while they show it swinging, others are taken, for
/// 3 s at most. How long that took is remembered by `Rig::settling`: the next stop waits as long
/// before its first frame. A single frame has none to be compared with, and is taken as it is.
/// Pixels that a frame lost on the way to this machine are taken from the others; if all frames
/// lost the same ones, up to 10 more are taken.
/// @param on_frame  called with each frame, also those that are left out
/// @return none if stopped first
/// @throws Error "sensor-..."
std::vector<DepthFrame> read_still_frames(Rig& rig, const PlatformLook& look, int count,
                                          const std::stop_token& stop, const OnFrame& on_frame);

/// Turns the platform to a stop and takes its depth image: frames, exposed while the platform
/// stands still, are merged by the settings' filter.
///
/// @return nullopt if stopped first
/// @throws Error "sensor-...", "turntable-..."
std::optional<DepthFrame> take_depth_image(Rig& rig, const Stop& at, const ScanSettings& settings,
                                           const std::stop_token& stop,
                                           const ScanObserver& observer);

}  // namespace octurn
