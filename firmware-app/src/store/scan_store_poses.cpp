// ScanStore: scans of other poses.

#include <algorithm>
#include <system_error>
#include <utility>

#include "octurn/file.hpp"
#include "store/build_file.hpp"
#include "store/scan_store.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw_data_error(folder, "make the folder", error);
  }
}

bool is_there(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

void move_folder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw_data_error(from, "move", error);
  }
}

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

/// Whether the chosen build merges the pose.
bool has_chosen_pose(const Job& job, const std::string& pose) {
  const Build* const chosen = find_build(job, job.builds.chosen);
  return chosen != nullptr && has_pose(*chosen, pose);
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

fs::path ScanStore::merged_scan(std::string_view id, const std::vector<std::string>& poses) const {
  if (poses.empty()) {
    return folder(id);
  }
  for (const Build& build : get(id).builds.all) {
    auto merged = model_file(id, build.number).parent_path() / merged_folder;
    std::error_code unreadable;
    if (build.poses == poses && fs::is_directory(merged, unreadable)) {
      return merged;
    }
  }
  throw Error(ErrorCode::no_model, "the merged poses of this scan are gone",
              "Choose the model as scanned.");
}

void ScanStore::withdraw_pose(std::string_view id, const std::string& pose) {
  const Job job = get(id);
  if (has_chosen_pose(job, pose)) {
    choose_build(id, build_before(job, pose));
  }
  for (const Build& build : job.builds.all) {
    if (has_pose(build, pose)) {
      remove_build(id, build.number);
    }
  }
}

/// Marks the pose first: until it is in the bin, the next start undoes what a power cut
/// interrupted.
void ScanStore::discard_pose(const std::string& id) {
  const Job first = get(get(id).pose_of.value().scan);
  const bool is_chosen = has_chosen_pose(first, id);
  const Job pose = update(
      id, [&](Job& job) { job.pose_of->removed_build = is_chosen ? first.builds.chosen : 0; });
  if (is_chosen) {
    choose_build(first.id, build_before(first, id));
  }
  const std::lock_guard writing(writing_);
  move_builds_out(first, id);
  move_to_bin(pose);
}

/// Moves the builds that merge a pose into the pose's folder. `writing_` is held.
void ScanStore::move_builds_out(const Job& first, const std::string& pose) {
  const fs::path builds = folder(first.id) / builds_folder;
  const fs::path removed = folder(pose) / removed_builds_folder;
  for (const Build& build : first.builds.all) {
    const std::string name = std::to_string(build.number);
    if (!has_pose(build, pose) || !is_there(builds / name)) {
      continue;
    }
    make_folder(removed);
    move_folder(builds / name, removed / name);
    sync_folder(removed);
    sync_folder(builds);
  }
  const std::lock_guard lock(mutex_);
  std::erase_if(jobs_.find(first.id)->second.builds.all,
                [&](const Build& build) { return has_pose(build, pose); });
  ++revision_;
}

/// Moves the builds of a removed pose back to its scan. A build whose number was given to another
/// one meanwhile gets the next. `writing_` is held.
/// @return the number of the one that was chosen; 0 if there is none
int ScanStore::move_builds_back(const Job& pose) {
  const fs::path removed = folder(pose.id) / removed_builds_folder;
  const fs::path scan = folder(pose.pose_of->scan);
  const fs::path builds = scan / builds_folder;
  int chosen = *pose.pose_of->removed_build;
  for (const std::string& name : names_in(removed)) {
    const int number = to_build_number(name);
    if (number == 0) {
      continue;
    }
    make_folder(builds);
    const int free = is_there(builds / name) ? next_build_number(scan) : number;
    move_folder(removed / name, builds / std::to_string(free));
    sync_folder(builds);
    sync_folder(removed);
    if (number == *pose.pose_of->removed_build) {
      chosen = free;
    }
  }
  std::error_code ignored;  // an empty folder does no harm
  fs::remove(removed, ignored);
  std::vector<Build> all = read_builds(scan);
  const std::lock_guard lock(mutex_);
  jobs_.find(pose.pose_of->scan)->second.builds.all = std::move(all);
  ++revision_;
  return chosen;
}

/// Joins a removed pose with its scan again, if that exists; other poses stay as they are.
/// `writing_` is held, or no other thread has this store yet.
void ScanStore::rejoin(const Job& pose) {
  if (!pose.pose_of->removed_build) {
    return;
  }
  if (find(pose.pose_of->scan)) {
    const int number = move_builds_back(pose);
    Job first = get(pose.pose_of->scan);
    const Build* const before = find_build(first, first.builds.chosen);
    const Build* const build = find_build(first, number);
    std::vector<std::string> poses = before ? before->poses : std::vector<std::string>{};
    poses.push_back(pose.id);
    if (build != nullptr && build->poses == poses) {
      first.builds.chosen = number;
      keep(first);
    }
  }
  Job joined = pose;
  joined.pose_of->removed_build.reset();
  keep(joined);
}

}  // namespace octurn
