#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "scan/job.hpp"

namespace octurn {

/// What a scan to come takes.
struct ScanEstimate {
  std::chrono::duration<double> stop = {};   ///< turning there, and its snapshot
  std::chrono::duration<double> build = {};  ///< from the last snapshot to the model
  std::uint64_t bytes = 0;                   ///< on the disk
  bool is_measured = false;                  ///< by earlier scans of this machine

  /// Of all: with one look more at the first stop, when all snapshots are there.
  std::chrono::duration<double> total(int snapshots) const {
    return stop * (snapshots + 1) + build;
  }
};

/// A finished scan, as far as it tells what another one takes.
struct EarlierScan {
  Job job = {};
  std::uint64_t snapshot_bytes = 0;  ///< on the disk, of all its snapshots
};

/// What a scan with those settings takes, by the earlier scans of this machine that are most like
/// it: medians over the last five of these. A stop is told by scans with the same filter, and among
/// them by those with about as many snapshots; a model by those with the same method, and among
/// them by those with about as large leaves. The leaves of a surface, and with them its time and
/// bytes, grow as the square of 1 / leaf size. Without an earlier scan: a stop takes 0.7 s and its
/// pictures at 30 Hz, a model 1 s and a snapshot 0.1 s with leaves of 1 mm.
/// @param earlier  the newest first
ScanEstimate estimate_scan(const std::vector<EarlierScan>& earlier, const ScanSettings& settings);

/// The middle value; of an even number the higher one of the two in the middle. @param values  any
std::chrono::duration<double> median(std::vector<std::chrono::duration<double>> values);

}  // namespace octurn
