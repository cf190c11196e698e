// Scanner: scans of other poses, and their removal.

#include <algorithm>
#include <mutex>
#include <system_error>

#include "build/merged_model.hpp"
#include "run/scanner.hpp"
#include "store/build_file.hpp"

namespace octurn {
namespace {

/// Whether a build merged a later pose with that one.
bool is_built_on(const Job& first, const std::string& pose) {
  return std::ranges::any_of(first.builds.all, [&](const Build& build) {
    return has_pose(build, pose) && build.poses.back() != pose;
  });
}

}  // namespace

std::optional<Job> Scanner::start_pose(std::string_view id, const ScanSettings& settings) {
  const std::lock_guard lock(scans_);
  const Job first = store_.get(id);
  if (first.pose_of) {
    throw Error(ErrorCode::no_model, "this scan is itself another pose of " + first.pose_of->scan,
                "Add the pose to that one.");
  }
  if (first.state != JobState::finished) {
    throw Error(ErrorCode::no_model, "this scan is " + std::string(to_string(first.state)),
                "Only a finished one gets another pose.");
  }
  if (slot_.has_scan()) {
    return std::nullopt;
  }
  const Job job = store_.create(settings, PoseOf{.scan = first.id});
  return hand_over(job, ScanCommand{job});
}

std::vector<Job> Scanner::poses(std::string_view id) const {
  std::vector<Job> poses = store_.poses(id);
  if (const std::optional<Job> now = running()) {
    std::ranges::replace_if(
        poses, [&](const Job& pose) { return pose.id == now->id; }, *now);
  }
  return poses;
}

Job Scanner::find_pose(std::string_view id, int number) const {
  store_.get(id);  // throws if there is no such scan
  const std::vector<Job> poses = store_.poses(id);
  if (number < 1 || number > static_cast<int>(poses.size())) {
    throw Error(ErrorCode::not_found, "this scan has no other pose " + std::to_string(number),
                "GET /api/v1/scans/ID/poses lists its poses.");
  }
  return poses[static_cast<std::size_t>(number) - 1];
}

void Scanner::expect_last_pose(const Job& pose) const {
  if (is_built_on(store_.get(pose.pose_of->scan), pose.id)) {
    throw Error(ErrorCode::busy, "a later pose was merged with this one",
                "Take the last pose back first.");
  }
}

std::optional<BuildRun> Scanner::choose_pose(std::string_view id, int number,
                                             const PoseChoice& choice) {
  const std::lock_guard lock(scans_);
  const Job pose = find_pose(id, number);
  expect_idle(pose.id);
  if (pose.state != JobState::finished) {
    throw Error(ErrorCode::no_model, "this pose is " + std::string(to_string(pose.state)),
                "Only one that was scanned can be joined.");
  }
  expect_last_pose(pose);
  const Job first = store_.get(id);
  int snapshots = first.snapshots_done + pose.snapshots_done;
  for (const std::string& other : merged_poses(first, pose.id)) {
    snapshots += store_.get(other).snapshots_done;
  }
  return offer_build(
      {.run = {.scan = first.id, .snapshots = snapshots, .settings = merged_settings(first, pose)},
       .becomes_model = true,
       .pose = choice});
}

void Scanner::remove_pose(std::string_view id, int number) {
  const std::lock_guard lock(scans_);
  remove_pose(find_pose(id, number));
}

/// `scans_` is held.
void Scanner::remove_pose(const Job& pose) {
  expect_idle(pose.id);
  expect_not_building(pose.pose_of->scan);
  expect_last_pose(pose);
  store_.discard_pose(pose.id);
}

void Scanner::remove_build(std::string_view id, int number) {
  std::error_code unreadable;
  const auto folder = store_.model_file(id, number).parent_path();
  if (number > 0 && std::filesystem::exists(folder / merged_folder, unreadable)) {
    throw Error(ErrorCode::busy, "this model belongs to a pose of the scan",
                "It goes with the pose.");
  }
  store_.remove_build(id, number);
}

}  // namespace octurn
