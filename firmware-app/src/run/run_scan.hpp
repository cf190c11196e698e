#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <stop_token>

#include "capture/capture.hpp"
#include "capture/scan_observer.hpp"
#include "store/job.hpp"

namespace octurn {

/// Takes a turn of snapshots into a scan folder, and builds `folder/Scan.stl` from them.
///
/// Each snapshot is on the disk before the platform moves on. Depth images are added to the
/// reconstruction while the platform turns; laser lines only after the turn, because the first
/// stop's surface ends at the last stop's lines. Stored snapshots are kept however the scan ends. A
/// folder with some snapshots is continued, and gives the same model as an uninterrupted scan.
///
/// Unless the settings say `configured`, the sensor's pose is solved from the snapshots at the last
/// stop. A pose that is accepted and does not merely confirm the configured one is stored beside it
/// in scan.json, and the model is built again from the stored snapshots. For the preview alone, it
/// is solved during the turn as well, as `PreviewSolves` says.
///
/// With a depth sensor, the platform turns on after the last stop to the first one's angle for one
/// more depth image, the last look. It is not part of the model; it measures how the object moved,
/// for scan.json and the verdict.
///
/// @return the model; nullopt if stopped first
/// @throws Error  if the sensor, the turntable or the disk fails, or there is no surface
std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Capture& capture,
                              const std::stop_token& stop, const ScanObserver& observer);

/// Says after which snapshots of a turn the sensor's pose is solved for the preview: once a third
/// of the turn is seen, since a quarter determines the axis. More views may determine what fewer
/// did not: a refused solution is tried again after a half and after two thirds, and then no more.
class PreviewSolves {
 public:
  /// @param snapshots  of the whole turn
  explicit PreviewSolves(int snapshots) : snapshots_(snapshots) {}

  /// Begins after the snapshots of an earlier attempt at the scan. While a device fails, attempts
  /// follow each other: none solves before it has taken a stop.
  void resume_after(int done) { after_ = done; }

  /// Whether the pose is to be solved after `done` snapshots.
  bool are_due(int done) const {
    return next_ < shares.size() && done > after_ && done < snapshots_ &&
           done >= std::max(shares[next_] * snapshots_, min_stops);
  }

  /// Records that the pose is solved after `done` snapshots.
  void take(int done) {
    do {
      ++next_;
    } while (next_ < shares.size() && shares[next_] * snapshots_ <= done);
  }

  /// Records that a solution was accepted: no other is needed.
  void end() { next_ = shares.size(); }

 private:
  static constexpr std::array shares{1.0 / 3, 1.0 / 2, 2.0 / 3};
  static constexpr double min_stops = 6;

  int snapshots_;
  int after_ = 0;
  std::size_t next_ = 0;  // index of the next share
};

}  // namespace octurn
