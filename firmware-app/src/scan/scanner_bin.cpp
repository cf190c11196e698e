// Scanner: deleting, restoring and importing scans.

#include <mutex>
#include <system_error>

#include "log.hpp"
#include "scan/scanner.hpp"

namespace octurn {

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
  if (scan && scan->job.pose_of && is_building(scan->job.pose_of->scan)) {
    throw Error(ErrorCode::busy, "a model of this scan is being built", "Cancel that first.");
  }
  store_.restore(id);
}

/// Checks that a scan neither runs nor is being built. @throws Error "busy"
void Scanner::expect_idle(std::string_view id) const {
  if (slot_.has_scan(id)) {
    throw Error(ErrorCode::busy, "this scan is running", "Cancel it first.");
  }
  if (is_building(id)) {
    throw Error(ErrorCode::busy, "a model of this scan is being built", "Cancel that first.");
  }
}

Job Scanner::adopt(const std::function<void(const std::filesystem::path& folder)>& fill,
                   std::uint64_t bytes) {
  store_.make_room(bytes, "a scan from a file");
  const std::filesystem::path folder = store_.begin_import();
  Job job;
  try {
    fill(folder);
    job = store_.adopt(folder);
  } catch (...) {
    std::error_code ignored;  // the next start removes leftovers
    std::filesystem::remove_all(folder, ignored);
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
