#include "store/scan_bin.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/file.hpp"
#include "store/data_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Parses a folder's name into time of deletion and id; nullopt for other names.
std::optional<std::pair<ScanTime, std::string>> parse_folder_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  if (dot == name.npos || !is_scan_id(name.substr(0, dot)) || !is_scan_id(name.substr(dot + 1))) {
    return std::nullopt;
  }
  return std::pair(to_time(name.substr(0, dot)), name.substr(dot + 1));
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
    const auto parts = parse_folder_name(name);
    std::error_code unknown;
    if (parts && fs::is_directory(folder_ / name, unknown)) {
      Job job = load(folder_ / name);
      job.id = parts->second;
      scans_.emplace(parts->second, BinnedScan{.job = std::move(job), .deleted = parts->first});
    }
  }
}

fs::path ScanBin::path(const BinnedScan& scan) const {
  return folder_ / (to_scan_id(scan.deleted) + "." + scan.job.id);
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

void ScanBin::take(const fs::path& scan, const Job& job, ScanTime now) {
  std::error_code error;
  fs::create_directories(folder_, error);
  const BinnedScan binned{.job = job, .deleted = now};
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

void ScanBin::remove_before(ScanTime time) {
  for (const BinnedScan& scan : list()) {
    if (scan.deleted < time) {
      remove(scan.job.id);
    }
  }
}

}  // namespace octurn
