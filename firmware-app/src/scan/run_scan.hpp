#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>

#include "scan/job.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// Told what a scan is doing, on the thread that runs it; `on_added` on that which adds snapshots,
/// while the platform turns.
struct ScanObserver {
  std::function<void(Phase phase, int snapshots_done)> on_progress = [](Phase, int) {};
  /// Before each move: where to, degrees.
  std::function<void(double angle_deg)> on_turn = [](double) {};
  std::function<void(const DepthFrame& frame, double depth_unit)> on_frame = [](const DepthFrame&,
                                                                                double) {};
  std::function<void(const Reconstructor& reconstruction, int snapshots)> on_added =
      [](const Reconstructor&, int) {};
  /// Now and then while the last snapshot is still being added.
  std::function<void()> on_wait = [] {};
};

/// Takes a turn of snapshots into a scan folder, and builds `folder/Scan.stl` from them.
///
/// Each snapshot is on the disk before the platform moves on, and goes into the octree while it
/// turns. What was stored stays, however the scan ends; a folder that holds some snapshots already
/// is continued with the next, and its model is that of a scan that was never disturbed.
///
/// @return the model, or nothing if stopped first
/// @throws Error  if the sensor, the turntable or the disk fails, or there is no surface
std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Rig& rig,
                              const std::stop_token& stop, const ScanObserver& observer);

}  // namespace octurn
