#include "store/scan_bin.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/file.hpp"
#include "store/data_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view unsure = ".unsure";

/// The id, the time of deletion, and whether that is sure, of a folder's name; nullopt for other
/// names.
std::optional<BinnedScan> parse_folder_name(std::string_view name) {
  const bool is_sure = !name.ends_with(unsure);
  name.remove_suffix(is_sure ? 0 : unsure.size());
  const std::size_t dot = name.find('.');
  if (dot == name.npos || !is_scan_id(name.substr(0, dot)) || !is_scan_id(name.substr(dot + 1))) {
    return std::nullopt;
  }
  return BinnedScan{.job = {.id = std::string(name.substr(dot + 1))},
                    .deleted = to_time(std::string(name.substr(0, dot))),
                    .time_is_sure = is_sure};
}

/// Counts the bytes that the removal of folders frees. A file with several names, such as a
/// snapshot of a merged scan, is freed with the last of them.
class FreedBytes {
 public:
  void add(const fs::path& folder) {
    std::error_code ignored;  // what cannot be read frees nothing
    for (fs::recursive_directory_iterator entry(folder, ignored), end; entry != end;
         entry.increment(ignored)) {
      struct stat status = {};
      if (::lstat(entry->path().c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
          ++names_[{status.st_dev, status.st_ino}] == status.st_nlink) {
        bytes_ += static_cast<std::uint64_t>(status.st_blocks) * block_bytes;
      }
    }
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  static constexpr std::uint64_t block_bytes = 512;  // of st_blocks, on every file system

  std::uint64_t bytes_ = 0;
  std::map<std::pair<dev_t, ino_t>, nlink_t> names_ = {};  // removed names of each file
};

}  // namespace

ScanBin::ScanBin(fs::path folder, const std::function<Job(const fs::path& folder)>& load)
    : folder_(std::move(folder)) {
  clear_unfinished(folder_);
  for (const std::string& name : names_in(folder_)) {
    std::optional<BinnedScan> scan = parse_folder_name(name);
    std::error_code unknown;
    if (scan && fs::is_directory(folder_ / name, unknown)) {
      const std::string id = std::exchange(scan->job, load(folder_ / name)).id;
      scan->job.id = id;
      scans_.emplace(id, *std::move(scan));
    }
  }
}

fs::path ScanBin::path(const BinnedScan& scan) const {
  return folder_ / (to_scan_id(scan.deleted) + "." + scan.job.id +
                    std::string(scan.time_is_sure ? "" : unsure));
}

std::vector<BinnedScan> ScanBin::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<BinnedScan> scans;
  for (const auto& [id, scan] : scans_) {
    scans.push_back(scan);
  }
  std::ranges::stable_sort(scans, std::ranges::greater(), &BinnedScan::deleted);
  return scans;
}

std::optional<BinnedScan> ScanBin::find(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(id);
  return found == scans_.end() ? std::nullopt : std::optional(found->second);
}

bool ScanBin::is_empty() const {
  const std::lock_guard lock(mutex_);
  return scans_.empty();
}

std::string ScanBin::newest_id() const {
  const std::lock_guard lock(mutex_);
  return scans_.empty() ? "" : scans_.rbegin()->first;
}

std::vector<std::string> ScanBin::oldest(std::uint64_t bytes) const {
  const std::vector<BinnedScan> scans = list();
  std::vector<std::string> ids;
  FreedBytes freed;
  for (auto scan = scans.rbegin(); scan != scans.rend() && freed.bytes() < bytes; ++scan) {
    freed.add(path(*scan));
    ids.push_back(scan->job.id);
  }
  return freed.bytes() < bytes ? std::vector<std::string>() : ids;
}

void ScanBin::take(const fs::path& scan, const Job& job, ScanTime now, bool time_is_sure) {
  std::error_code error;
  fs::create_directories(folder_, error);
  const BinnedScan binned{.job = job, .deleted = now, .time_is_sure = time_is_sure};
  if (!error) {
    fs::rename(scan, path(binned), error);
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    throw_data_error(scan, "move into the bin", error);
  }
  if (error) {
    return;  // somebody has removed the folder: there is nothing to keep
  }
  sync_folder(folder_);
  sync_folder(scan.parent_path());
  const std::lock_guard lock(mutex_);
  scans_.insert_or_assign(job.id, binned);
}

void ScanBin::put_back(std::string_view id, const fs::path& scan) {
  const auto binned = find(id);
  std::error_code error;
  fs::rename(path(binned.value()), scan, error);
  if (error) {
    throw_data_error(path(*binned), "restore", error);
  }
  sync_folder(scan.parent_path());
  sync_folder(folder_);
  const std::lock_guard lock(mutex_);
  scans_.erase(scans_.find(id));
}

void ScanBin::remove(std::string_view id) {
  const auto binned = find(id);
  const fs::path leaving = folder_ / ("." + std::string(id));
  std::error_code error;
  // Renamed first, so that a partly removed scan is never listed.
  fs::rename(path(binned.value()), leaving, error);
  if (error && error != std::errc::no_such_file_or_directory) {
    throw_data_error(path(*binned), "remove", error);
  }
  {
    const std::lock_guard lock(mutex_);
    scans_.erase(scans_.find(id));
  }
  fs::remove_all(leaving, error);
  if (error) {
    log::warning("store", leaving.string() + ": cannot remove: " + error.message());
  }
}

void ScanBin::expire(ScanTime now) {
  for (const BinnedScan& scan : list()) {
    if (!scan.time_is_sure) {
      take(path(scan), scan.job, now, true);
    } else if (scan.deleted < now - days_in_bin) {
      remove(scan.job.id);
    }
  }
}

}  // namespace octurn
