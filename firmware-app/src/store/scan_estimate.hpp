#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "store/job.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// Expected time and disk space of a scan.
struct ScanEstimate {
  Seconds stop = {};         ///< turning to a stop, and its snapshot
  Seconds build = {};        ///< from the last snapshot to the model
  std::uint64_t bytes = 0;   ///< on the disk
  bool is_measured = false;  ///< based on earlier scans of this machine

  /// Time of the whole scan, including the last look.
  Seconds total(int snapshots) const { return stop * (snapshots + 1) + build; }
};

/// A finished scan, from which another one is estimated.
struct EarlierScan {
  Job job = {};
  std::uint64_t snapshot_bytes = 0;  ///< on the disk, of all its snapshots
};

/// Estimates a scan from the earlier scans of this machine that are most like it: medians over the
/// last five of these. For a stop these are scans with the same filter, preferably with about as
/// many snapshots; for a model scans with the same method, preferably with about as large leaves.
/// The leaves of a surface, and with them its time and bytes, grow as the square of 1 / leaf size.
/// Without an earlier scan, a stop takes the turn to it at the default speeds plus 0.5 s plus its
/// frames at 30 Hz, and a model with leaves of 1 mm takes 1 s plus 0.15 s for each snapshot.
/// @param earlier  the newest first
ScanEstimate estimate_scan(const std::vector<EarlierScan>& earlier, const ScanSettings& settings);

/// Returns the last twenty finished scans of a store, newest first, with the sizes of their
/// snapshots on the disk.
std::vector<EarlierScan> earlier_scans(const ScanStore& store);

}  // namespace octurn
