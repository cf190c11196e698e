#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "scan/calibration_turn.hpp"

namespace octurn {

/// Takes the pictures of one turn with a camera and lasers, and solves its pose and their planes
/// from them. Nothing is stored.
///
/// @param settings  `snapshots` are the stops
/// @param data      the data folder: the pictures are in a folder there, until this returns
/// @return nothing if stopped first
/// @throws Error "sensor-...", "turntable-...", "disk-full", "write-failed"
std::optional<TurnReport> measure_laser_turn(const ScanSettings& settings,
                                             const std::filesystem::path& data, int threads,
                                             Rig& rig, const std::stop_token& stop,
                                             const ScanObserver& observer);

}  // namespace octurn
