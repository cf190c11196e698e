// ScanStore: scans of other poses.

#include <algorithm>
#include <system_error>

#include "scan/build_file.hpp"
#include "scan/scan_store.hpp"

namespace octurn {
namespace {

/// Returns the number of the build to choose without a pose: the one that was chosen before the
/// first build with that pose; 0 if it was removed.
int build_before(const Job& job, const std::string& pose) {
  const auto first = std::ranges::find_if(
      job.builds.all, [&](const Build& build) { return has_pose(build, pose); });
  if (first == job.builds.all.end() || find_build(job, first->replaced) == nullptr) {
    return 0;
  }
  return first->replaced;
}

}  // namespace

std::vector<Job> ScanStore::poses(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> poses;
  for (const auto& [other, job] : jobs_) {
    if (job.pose_of && job.pose_of->scan == id) {
      poses.push_back(job);
    }
  }
  std::ranges::reverse(poses);  // `jobs_` is in order of time, newest first
  return poses;
}

std::filesystem::path ScanStore::merged_scan(std::string_view id,
                                             const std::vector<std::string>& poses) const {
  if (poses.empty()) {
    return folder(id);
  }
  for (const Build& build : get(id).builds.all) {
    auto merged = model_file(id, build.number).parent_path() / merged_folder;
    std::error_code unreadable;
    if (build.poses == poses && std::filesystem::is_directory(merged, unreadable)) {
      return merged;
    }
  }
  throw Error(ErrorCode::no_model, "the merged poses of this scan are gone",
              "Choose the model as scanned.");
}

void ScanStore::withdraw_pose(std::string_view id, const std::string& pose) {
  const Job job = get(id);
  if (const Build* const chosen = find_build(job, job.builds.chosen);
      chosen != nullptr && has_pose(*chosen, pose)) {
    choose_build(id, build_before(job, pose));
  }
  for (const Build& build : job.builds.all) {
    if (has_pose(build, pose)) {
      remove_build(id, build.number);
    }
  }
}

}  // namespace octurn
