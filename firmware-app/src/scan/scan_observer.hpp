#pragma once

#include <functional>

#include "octurn/depth_png.hpp"
#include "octurn/reconstruct.hpp"
#include "scan/job.hpp"
#include "scan/solve_pose.hpp"

namespace octurn {

/// Told what a scan is doing, on the thread that runs it; `on_added` on that which adds snapshots,
/// while the platform turns.
struct ScanObserver {
  std::function<void(Phase phase, int snapshots_done)> on_progress = [](Phase, int) {};
  /// Before each move: where to, degrees.
  std::function<void(double angle_deg)> on_turn = [](double) {};
  std::function<void(const DepthFrame& frame)> on_frame = [](const DepthFrame&) {};
  std::function<void(const Picture& picture)> on_picture = [](const Picture&) {};
  std::function<void(const Reconstructor& reconstruction, int snapshots)> on_added =
      [](const Reconstructor&, int) {};
  /// What the snapshots tell of the sensor's pose and the lasers' planes, before anything is done
  /// about it.
  std::function<void(const ScanSolution& solution)> on_calibrated = [](const ScanSolution&) {};
  /// Now and then while the model is built again: of how many snapshots by then.
  std::function<void(int snapshots)> on_rebuilt = [](int) {};
  /// Now and then while a snapshot is still being added.
  std::function<void()> on_wait = [] {};
};

}  // namespace octurn
