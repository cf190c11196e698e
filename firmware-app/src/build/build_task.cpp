#include "build/build_task.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "build/merged_model.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "store/build_file.hpp"
#include "store/calibration_json.hpp"
#include "store/job_file.hpp"

namespace octurn {
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

}  // namespace octurn
