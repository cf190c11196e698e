// ScanStore: deleting and restoring scans.

#include <chrono>

#include "log.hpp"
#include "store/scan_store.hpp"

namespace octurn {
namespace {

ScanTime now() { return std::chrono::floor<ScanTime::duration>(std::chrono::system_clock::now()); }

}  // namespace

/// `writing_` is held.
void ScanStore::move_to_bin(const Job& job) {
  bin_.take(folder(job.id), job, now());
  const std::lock_guard lock(mutex_);
  jobs_.erase(job.id);
  ++revision_;
}

/// `writing_` is held.
void ScanStore::move_from_bin(const BinnedScan& scan) {
  bin_.put_back(scan.job.id, folder(scan.job.id));
  const std::lock_guard lock(mutex_);
  jobs_.insert_or_assign(scan.job.id, scan.job);
  ++revision_;
}

/// Moves the scan before its poses, so that `finish_discards` can complete a move that a power cut
/// interrupted.
void ScanStore::discard(std::string_view id) {
  const std::lock_guard writing(writing_);
  const Job job = get(id);
  const std::vector<Job> others = poses(id);
  move_to_bin(job);
  for (const Job& other : others) {
    move_to_bin(other);
  }
  bin_.remove_before(now() - days_in_bin);
}

void ScanStore::restore(std::string_view id) {
  const std::lock_guard writing(writing_);
  const auto scan = bin_.find(id);
  if (!scan) {
    throw Error(ErrorCode::no_such_scan, "there is no scan " + std::string(id) + " in the bin",
                "GET /api/v1/bin lists them.");
  }
  if (!scan->job.pose_of) {
    restore_with_poses(*scan);
    return;
  }
  if (const auto first = bin_.find(scan->job.pose_of->scan)) {
    restore_with_poses(*first);
  }
  if (bin_.find(id)) {
    move_from_bin(*scan);
    rejoin(scan->job);
  }
}

/// Moves a scan out of the bin, with the poses that were deleted with it. `writing_` is held.
void ScanStore::restore_with_poses(const BinnedScan& first) {
  move_from_bin(first);
  for (const BinnedScan& other : bin_.list()) {
    if (other.job.pose_of && other.job.pose_of->scan == first.job.id &&
        !other.job.pose_of->removed_build) {
      move_from_bin(other);
    }
  }
}

void ScanStore::empty_bin() {
  const std::lock_guard writing(writing_);
  for (const BinnedScan& scan : bin_.list()) {
    bin_.remove(scan.job.id);
  }
}

void ScanStore::make_room(std::uint64_t needed, const std::string& what) {
  const std::lock_guard writing(writing_);
  const std::uint64_t free = free_bytes();
  if (free < needed) {
    for (const std::string& id : bin_.oldest(needed - free)) {
      log::info("store", std::string("scan ")
                             .append(id)
                             .append(" leaves the bin: its space is needed for ")
                             .append(what));
      bin_.remove(id);
    }
  }
  expect_room(data_, free_bytes(), needed, what);
}

/// Completes moves that a power cut interrupted: poses follow their scan into the bin, or out of
/// it. A pose that was being removed from its scan, or was returning to it, joins it again. Removes
/// expired scans.
void ScanStore::finish_discards() {
  try {
    for (const Job& job : list()) {
      if (job.pose_of && !find(job.pose_of->scan) && bin_.find(job.pose_of->scan)) {
        move_to_bin(job);
      } else if (job.pose_of) {
        rejoin(job);
      }
    }
    for (const BinnedScan& scan : bin_.list()) {
      if (scan.job.pose_of && !scan.job.pose_of->removed_build && find(scan.job.pose_of->scan)) {
        move_from_bin(scan);
      }
    }
    bin_.remove_before(now() - days_in_bin);
  } catch (const Error& error) {
    log::warning("store", error.what());  // a full or read-only disk: the next start tries again
  }
}

}  // namespace octurn
