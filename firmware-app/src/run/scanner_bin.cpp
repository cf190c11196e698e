// Scanner: deleting, restoring and importing scans.

#include <cstdint>
#include <filesystem>
#include <future>
#include <mutex>
#include <system_error>

#include "log.hpp"
#include "run/scanner.hpp"
#include "store/data_folder.hpp"
#include "store/scan_archive.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t import_factor = 3;  // the archive, its files, and their model
constexpr const char* scan_from_file = "a scan from a file";

std::mutex checking;  // one archive at a time: a check takes up to 100 MB of memory

/// Checks that room can be made, without making it.
/// @throws Error "disk-full"  if the free space and the bin's do not suffice
void expect_possible_room(const ScanStore& store, std::uint64_t needed) {
  const std::uint64_t free = store.free_bytes();
  if (free < needed && store.bin().oldest(needed - free).empty()) {
    expect_room(store.data(), free, needed, scan_from_file);
  }
}

/// Receives an archive, checks it, and adds its scan to the store.
Job take_archive(ScanStore& store, const ArchiveSource& archive, const fs::path& folder,
                 const std::stop_token& stop) {
  const fs::path file = folder / ".scan.zip";
  receive_archive(
      archive, file, [&](std::uint64_t bytes) { store.make_room(bytes, scan_from_file); }, stop);
  const std::lock_guard lock(checking);
  throw_if_stopped(stop);
  const auto unpack = [&] {
    check_archive_files(file);
    store.make_room((import_factor - 1) * archive.bytes, scan_from_file);
    read_scan_archive(file, folder, stop);
  };
  std::async(std::launch::async, unpack).get();  // on a larger stack than a server thread's
  std::error_code ignored;
  fs::remove(file, ignored);
  return store.adopt(folder);
}

void remove_import(const fs::path& folder) {
  std::error_code ignored;  // the next start removes leftovers
  fs::remove_all(folder, ignored);
}

}  // namespace

void Scanner::remove(std::string_view id) {
  const std::lock_guard lock(scans_);
  const Job job = store_.get(id);
  if (job.pose_of && store_.find(job.pose_of->scan)) {
    remove_pose(job);
    return;
  }
  const std::vector<Job> poses = store_.poses(id);
  for (const Job& pose : poses) {
    expect_idle(pose.id);
  }
  expect_idle(id);
  store_.discard(id);
}

void Scanner::restore(std::string_view id) {
  const std::lock_guard lock(scans_);
  const auto scan = store_.bin().find(id);
  if (scan && scan->job.pose_of) {
    expect_not_building(scan->job.pose_of->scan);
  }
  store_.restore(id);
}

/// Checks that a scan neither runs nor is being built. @throws Error "busy"
void Scanner::expect_idle(std::string_view id) const {
  if (slot_.has_scan(id)) {
    throw Error(ErrorCode::busy, "this scan is running", "Cancel it first.");
  }
  expect_not_building(id);
}

/// @throws Error "busy"  if a model of the scan is being built
void Scanner::expect_not_building(std::string_view id) const {
  if (is_building(id)) {
    throw Error(ErrorCode::busy, "a model of this scan is being built", "Cancel that first.");
  }
}

Job Scanner::adopt(const ArchiveSource& archive) {
  expect_possible_room(store_, import_factor * archive.bytes);
  const std::filesystem::path folder = store_.begin_import();
  Job job;
  try {
    job = take_archive(store_, archive, folder, ending_.get_token());
  } catch (const Stopped&) {
    remove_import(folder);
    throw Error(ErrorCode::busy, "Octurn is ending", "Send the file again when it is back.");
  } catch (...) {
    remove_import(folder);
    throw;
  }
  if (!slurm_) {
    return resume(job.id).value_or(job);
  }
  try {
    build(job.id, {.settings = {.scan = job.settings}, .becomes_model = true});
  } catch (const Error& error) {  // the scan is imported, and can be built later
    log::warning("scanner", "scan " + job.id + " is not built: " + error.what());
  }
  return job;
}

}  // namespace octurn
