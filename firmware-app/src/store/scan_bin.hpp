#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/job.hpp"

namespace octurn {

/// How long a deleted scan is kept, unless its space is needed.
inline constexpr std::chrono::days days_in_bin{30};

/// A scan that was deleted, and can be restored.
struct BinnedScan {
  Job job = {};
  ScanTime deleted = {};
  bool time_is_sure = true;  ///< the clock was right then
};

/// The deleted scans: `DATA/bin/<when>.<id>/`, each an unchanged scan folder, named after the time
/// of deletion; `<when>.<id>.unsure/` if the clock was doubtful then. Scans are moved by renaming
/// their folders: after a power cut, a scan is complete in one of the two places. Const functions
/// are thread-safe; the others are called by one thread at a time.
class ScanBin {
 public:
  /// Completes interrupted removals, and reads the bin.
  /// @param load  reads the job of a scan's folder
  ScanBin(std::filesystem::path folder,
          const std::function<Job(const std::filesystem::path& folder)>& load);

  /// Lists the scans, last deleted first.
  std::vector<BinnedScan> list() const;
  std::optional<BinnedScan> find(std::string_view id) const;
  bool is_empty() const;

  /// Returns the newest id of a scan in the bin; empty if there is none.
  std::string newest_id() const;

  /// Lists the ids of the scans, first deleted first, whose removal frees at least that many bytes:
  /// no more than needed. Empty if not even the removal of all scans frees them.
  std::vector<std::string> oldest(std::uint64_t bytes) const;

  /// Moves a scan into the bin. @throws Error "data-failed", "disk-full"
  void take(const std::filesystem::path& scan, const Job& job, ScanTime now, bool time_is_sure);

  /// Moves a scan back to its folder. @param id  of a scan in the bin @throws Error "data-failed"
  void put_back(std::string_view id, const std::filesystem::path& scan);

  /// Removes a scan permanently. @param id  of a scan in the bin @throws Error "data-failed"
  void remove(std::string_view id);

  /// Removes the scans that were deleted more than `days_in_bin` ago. Those of which the time is
  /// not sure count from now on. @param now  by a clock that is right
  void expire(ScanTime now);

 private:
  std::filesystem::path path(const BinnedScan& scan) const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_;  // guards scans_; never held during disk access
  std::map<std::string, BinnedScan, std::less<>> scans_;  // by id
};

}  // namespace octurn
