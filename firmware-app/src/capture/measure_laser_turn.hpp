#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "capture/calibration_turn.hpp"

namespace octurn {

/// Takes the pictures of one turn with a camera and lasers, and solves the camera's pose and the
/// lasers' planes from them. Nothing is stored.
///
/// @param settings  `snapshots` is the number of stops
/// @param data      the data folder, which holds the pictures until this returns
/// @return nullopt if stopped first
/// @throws Error "sensor-...", "turntable-...", "disk-full", "write-failed"
std::optional<TurnReport> measure_laser_turn(const ScanSettings& settings,
                                             const std::filesystem::path& data, int threads,
                                             Rig& rig, const std::stop_token& stop,
                                             const ScanObserver& observer);

}  // namespace octurn
