#include "build/build_model.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "capture/last_look.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "settings/field.hpp"
#include "store/job_file.hpp"
#include "store/job_json.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

/// Returns the model's clip box: that of the settings. If it is the scan's own box, a scan of
/// several poses has the box that encloses the clip boxes of all poses instead.
Box choose_clip(const Scan& scan, const BuildInput& input) {
  const Box& wanted = input.settings.scan.clip;
  const Box& own = input.job.settings.clip;
  const bool is_own = wanted.min == own.min && wanted.max == own.max;
  return is_own && !scan.poses.empty() ? model_clip(scan) : wanted;
}

std::vector<CalibrationFinding> calibration_findings(const Job& job) {
  return job.calibration ? job.calibration->findings : std::vector<CalibrationFinding>{};
}

Phase to_phase(BuildStep step) {
  constexpr std::array phases{Phase::calibrating, Phase::rebuilding, Phase::building};
  return phases[static_cast<std::size_t>(step)];
}

/// Returns what is known of the scan's own calibration, or of those of all poses' scans.
std::vector<CalibrationFinding> known_findings(const BuildInput& input, const Scan& scan) {
  return input.findings ? *input.findings
         : scan.solved  ? calibration_findings(input.job)
                        : std::vector<CalibrationFinding>();
}

/// Returns the findings of a scan's calibration and of its last look.
/// @param folder  of the scan. @throws Error  as `read_scan`
std::vector<CalibrationFinding> scan_findings(const Job& job, const std::filesystem::path& folder) {
  auto findings = calibration_findings(job);
  add_stored_move(folder, findings);
  return findings;
}

}  // namespace

std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress) try {
  const Clock::time_point begin = Clock::now();
  const BuildSettings& settings = input.settings;
  Scan scan = scan_to_build(input.folder, settings);
  ReconstructOptions options = checked_options(settings.scan, limits, scan.shots.size());
  options.level = settings.level;
  add_edits(options, settings.edits);
  options.clip = choose_clip(scan, input);
  const auto& calibration = input.job.calibration;
  ModelInput model{
      .folder = input.folder,
      .options = std::move(options),
      .solves_pose = !input.findings && settings.scan.pose == PoseSource::solved,
      .findings = known_findings(input, scan),
      .seen_optics = calibration ? calibration->optics : std::optional<SolvedOptics>(),
      .snapshots = [&](const Scan& posed) { return readable_snapshots(input.folder, posed, stop); },
      .write =
          [&](Reconstructor& reconstructor, const SnapshotSource& snapshots) {
            return write_model(reconstructor, snapshots, file, stop);
          },
      .progress = [&](BuildStep step, int done) { progress(to_phase(step), done); }};
  model.scan = std::move(scan);
  BuiltModel built = build_model(std::move(model), stop);
  built.report->places = {};  // dropped: every request for a job's state copies it
  Build build{.settings = settings};
  if (built.calibration) {
    build.calibration = to_scan_calibration(*built.calibration);
  }
  build.model = {.report = *std::move(built.report),
                 .build_time = Clock::now() - begin,
                 .quality = std::move(built.quality)};
  return build;
} catch (const Stopped&) {
  return std::nullopt;
}

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int max_int = std::numeric_limits<int>::max();

BuildRun run_from(JsonObject& keys) {
  return {.scan = keys.at("scan").text(),
          .number = keys.at("build").whole_number(1, max_int),
          .created = keys.at("created").text(),
          .snapshots = keys.at("snapshots").whole_number(0, max_int),
          .settings = stored_build_settings_from(keys.at("settings"))};
}

Limits limits_from(const JsonValue& object) {
  JsonObject keys(object);
  Limits limits;
  read_fields(keys, fields(limits));
  return limits;
}

}  // namespace

BuildTask make_task(const ScanStore& store, const BuildRun& run, bool becomes_model) {
  BuildTask task{.run = run, .becomes_model = becomes_model, .job = store.get(run.scan)};
  if (const Build* const chosen = find_build(task.job, task.job.builds.chosen)) {
    task.poses = chosen->poses;
  }
  task.folder = store.merged_scan(run.scan, task.poses);
  task.findings = pose_findings(store, task.job, task.poses);
  return task;
}

std::optional<Build> build_model(const BuildTask& task, const Limits& limits, const fs::path& file,
                                 const std::stop_token& stop, const BuildProgress& progress) {
  std::optional<Build> build = build_model({.job = task.job,
                                            .folder = task.folder,
                                            .settings = task.run.settings,
                                            .findings = task.findings},
                                           limits, file, stop, progress);
  if (build) {
    build->poses = task.poses;
    build->number = task.run.number;
    build->created = task.run.created;
  }
  return build;
}

void choose_built(ScanStore& store, const BuildTask& task) {
  if (task.becomes_model || !chosen_model(store.get(task.run.scan))) {
    store.choose_build(task.run.scan, task.run.number);
  }
}

void write_task(const fs::path& folder, const BuildTask& task, const Limits& limits) {
  const BuildRun& run = task.run;
  Limits copy = limits;
  const json document{{"scan", run.scan},
                      {"build", run.number},
                      {"created", run.created},
                      {"snapshots", run.snapshots},
                      {"settings", to_json(run.settings)},
                      {"becomes_model", task.becomes_model},
                      {"job", to_job_json(task.job)},
                      {"folder", fs::absolute(task.folder).string()},
                      {"poses", task.poses},
                      {"findings", task.findings ? to_json(*task.findings) : json()},
                      {"limits", to_json(fields(copy))}};
  write_file(folder / task_file,
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

StoredTask read_task(const fs::path& folder) {
  const json document =
      parse_json(read_regular_file(folder / task_file, max_json_bytes).value_or(""),
                 ErrorCode::job_malformed, task_file);
  JsonObject keys(document, ErrorCode::job_malformed, "");
  StoredTask stored{.task = {.run = run_from(keys),
                             .becomes_model = keys.at("becomes_model").flag(),
                             .job = to_job(keys.at("job").json()),
                             .folder = keys.at("folder").text()},
                    .limits = limits_from(keys.at("limits"))};
  for (const JsonValue& pose : keys.at("poses").elements()) {
    stored.task.poses.push_back(pose.text());
  }
  if (const JsonValue findings = keys.at("findings"); !findings.json().is_null()) {
    stored.task.findings = to_findings(findings);
  }
  return stored;
}

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
