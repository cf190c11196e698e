#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/job.hpp"
#include "scan/scan_id.hpp"

namespace octurn {

/// How long a deleted scan is kept, unless its space is needed.
inline constexpr std::chrono::days days_in_bin{30};

/// A scan that was deleted, and can be restored.
struct BinnedScan {
  Job job = {};
  ScanTime deleted = {};
};

/// The scans that were deleted: `DATA/bin/<when>.<id>/`, each a scan's folder as it was, under a
/// name that tells when. A scan comes and goes by renaming its folder, so it is whole at one of the
/// two places, whenever the power goes. Any thread may look; what changes the bin is called by one
/// thread at a time.
class ScanBin {
 public:
  /// Completes interrupted removals, and reads the bin.
  /// @param load  reads the job of a scan's folder
  ScanBin(std::filesystem::path folder,
          const std::function<Job(const std::filesystem::path& folder)>& load);

  /// The last deleted scan first.
  std::vector<BinnedScan> list() const;
  std::optional<BinnedScan> find(std::string_view id) const;
  bool is_empty() const;

  /// The newest id of a scan in it; empty if there is none.
  std::string newest_id() const;

  /// Takes a scan in. @throws Error "data-failed", "disk-full"
  void take(const std::filesystem::path& scan, const Job& job, ScanTime now);

  /// Puts a scan back where it was. @param id  that is here @throws Error "data-failed"
  void put_back(std::string_view id, const std::filesystem::path& scan);

  /// Removes a scan for good. @param id  that is here @throws Error "data-failed"
  void remove(std::string_view id);

  /// Removes what was deleted before a time.
  void remove_before(ScanTime time);

 private:
  std::filesystem::path folder_of(const BinnedScan& scan) const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_;  // guards scans_, and is never held while the disk is used
  std::map<std::string, BinnedScan, std::less<>> scans_;  // by id
};

}  // namespace octurn
