#include "build/merged_model.hpp"

#include <algorithm>
#include <utility>

#include "octurn/error.hpp"
#include "store/build_file.hpp"

namespace octurn {
namespace {

/// Stores and chooses a build of all poses, and removes the builds with the last pose's earlier
/// registration.
void replace_builds(ScanStore& store, const std::string& id, Build build, const std::string& pose) {
  const JobBuilds builds = store.get(id).builds;  // a person may have chosen another one meanwhile
  const auto before =
      std::ranges::find_if(builds.all, [&](const Build& other) { return has_pose(other, pose); });
  build.replaced = before == builds.all.end() ? builds.chosen : before->replaced;
  store.add_build(id, build);
  store.choose_build(id, build.number);
  for (const Build& other : builds.all) {
    if (has_pose(other, pose)) {
      store.remove_build(id, other.number);
    }
  }
}

}  // namespace

std::vector<std::string> merged_poses(const Job& first, const std::string& without) {
  std::vector<std::string> poses;
  for (const Build& build : first.builds.all) {
    const auto end = std::ranges::find(build.poses, without);
    if (std::distance(build.poses.begin(), end) > std::ssize(poses)) {
      poses.assign(build.poses.begin(), end);
    }
  }
  return poses;
}

BuildSettings merged_settings(const Job& first, const Job& pose) {
  BuildSettings settings{.scan = pose.settings};
  settings.scan.clip = first.settings.clip;
  return settings;
}

std::optional<std::vector<CalibrationFinding>> pose_findings(
    const ScanStore& store, const Job& first, const std::vector<std::string>& poses) {
  if (poses.empty()) {
    return std::nullopt;
  }
  auto findings = scan_findings(first, store.folder(first.id));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (CalibrationFinding& finding : scan_findings(store.get(poses[i]), store.folder(poses[i]))) {
      finding.detail.insert(0, "side " + std::to_string(i + 2) + ": ");
      finding.parameters.emplace("object_side", static_cast<double>(i + 2));
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

std::optional<Build> build_merged(ScanStore& store, const Job& first, const MergedTurns& merged,
                                  const BuildSettings& settings, int number, const Limits& limits,
                                  const std::stop_token& stop, const BuildProgress& progress) {
  const std::filesystem::path file = store.begin_build(first.id, number);
  const std::filesystem::path folder = file.parent_path() / merged_folder;
  write_merged_scan(folder, merged.turns, merged.registration);
  auto build = build_model({.job = first,
                            .folder = folder,
                            .settings = settings,
                            .findings = pose_findings(store, first, merged.poses)},
                           limits, file, stop, progress);
  if (build) {
    build->number = number;
    build->poses = merged.poses;
  }
  return build;
}

bool refit_pose(ScanStore& store, const BuildRun& run, const PoseChoice& choice,
                const Limits& limits, const std::stop_token& stop,
                const BuildProgress& progress) try {
  progress(Phase::registering, 0);
  const Job first = store.get(run.scan);
  const Job pose = store.get(choice.pose);
  std::vector<std::string> poses = merged_poses(first, pose.id);
  std::vector<StoredTurn> turns =
      read_turns({store.merged_scan(first.id, poses), store.folder(pose.id)});
  turns.back().prior_object_from_platform = choice.object_from_platform;
  const Registration registration = register_turns(turns, limits.threads, stop);
  if (!registration.accepted) {
    throw Error(ErrorCode::no_model, registration.reason, "The model stayed as it was.");
  }
  poses.push_back(pose.id);
  auto build =
      build_merged(store, first, {.turns = turns, .registration = registration, .poses = poses},
                   run.settings, run.number, limits, stop, progress);
  if (!build) {
    return false;
  }
  build->created = run.created;
  replace_builds(store, first.id, *std::move(build), pose.id);
  store.update(pose.id, [&](Job& stored) {
    auto& known = stored.pose_of->registration;
    known = PoseRegistration{
        .accepted = true,
        .pose = registration.poses.back(),
        .candidates = known ? known->candidates : std::vector<RegistrationCandidate>{},
        .candidate = choice.candidate};
  });
  return true;
} catch (const Stopped&) {
  return false;
}

}  // namespace octurn
