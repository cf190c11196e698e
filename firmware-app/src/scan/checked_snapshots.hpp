#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "octurn/quality.hpp"
#include "octurn/snapshot.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

/// Options for a model whose snapshots are also checked, and whose pose may be solved: the memory
/// that this takes is added to `program_memory`.
ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots);

/// Checks the depth images of a scan, each by the platform and clip box of its pose.
class PoseChecks {
 public:
  /// @param placements  of the poses; none: there is one, with that clip box
  /// @param stops       of all poses
  PoseChecks(std::vector<Placement> placements, const Box& clip, std::size_t stops);

  /// @param stop  below the number of stops. @throws  as `ScanCheck::add`; called as that is
  void add(std::size_t stop, const Snapshot& snapshot);

  /// The figures of each pose, places in the object's frame.
  std::vector<ScanFigures> figures(int threads) const;

 private:
  std::vector<Placement> placements_;
  std::vector<std::unique_ptr<ScanCheck>> checks_;
};

/// The same snapshots; each one that is read is added to `checks`, which must outlive them.
SnapshotSource checked_snapshots(SnapshotSource snapshots, PoseChecks& checks);

}  // namespace octurn
