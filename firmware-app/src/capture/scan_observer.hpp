#pragma once

#include <functional>

#include "octurn/calibrate.hpp"
#include "octurn/png.hpp"
#include "octurn/reconstruct.hpp"
#include "store/job.hpp"

namespace octurn {

/// Callbacks of a scan, on its thread; `on_added` is called on the thread that adds snapshots while
/// the platform turns.
struct ScanObserver {
  /// When a phase begins, and as soon as a snapshot is stored, since adding it may fail.
  std::function<void(Phase phase, int snapshots_done)> on_progress = [](Phase, int) {};
  /// Before each move, with the angle of its end, degrees.
  std::function<void(double angle_deg)> on_turn = [](double) {};
  /// When a picture shows that the motor lost steps. The stop is then taken again.
  std::function<void()> on_slip = [] {};
  std::function<void(const DepthFrame& frame)> on_frame = [](const DepthFrame&) {};
  std::function<void(const Picture& picture)> on_picture = [](const Picture&) {};
  std::function<void(const Reconstructor& reconstruction, int snapshots)> on_added =
      [](const Reconstructor&, int) {};
  /// After the pose, and lasers' planes, were solved or refused, before the result is used.
  std::function<void(const ScanSolution& solution)> on_calibrated = [](const ScanSolution&) {};
  /// After the clip box was lowered to that height, metres, since the object was below it.
  std::function<void(double bottom)> on_lowered = [](double) {};
  /// Repeatedly while the model is built again, with the number of snapshots added.
  std::function<void(int snapshots)> on_rebuilt = [](int) {};
  /// Repeatedly while the scan waits for a snapshot to be added.
  std::function<void()> on_wait = [] {};
};

}  // namespace octurn
