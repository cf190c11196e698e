#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "octurn/quality.hpp"
#include "octurn/snapshot.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// Returns options for a model whose snapshots are also checked. `program_memory` includes the
/// memory of the checks, and of solving the pose if the settings ask for it.
ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots);

/// Quality checks of a scan's depth images. Each pose has its own platform frame and clip box.
class PoseChecks {
 public:
  /// @param placements  one for each pose; empty: one pose with the clip box `clip`
  /// @param stops       number of stops, of all poses together
  PoseChecks(std::vector<Placement> placements, const Box& clip, std::size_t stops);

  /// Adds a stop's snapshot. Threads and errors are as of `ScanCheck::add`.
  /// @param stop  index, below the number of stops
  void add(std::size_t stop, const Snapshot& snapshot);

  /// Returns the figures of each pose, with places in the object's frame.
  std::vector<ScanFigures> figures(int threads) const;

 private:
  std::vector<Placement> placements_;
  std::vector<std::unique_ptr<ScanCheck>> checks_;
};

/// Wraps a source: each snapshot that is read is also added to `checks`, which must outlive it.
SnapshotSource checked_snapshots(SnapshotSource snapshots, PoseChecks& checks);

}  // namespace octurn
