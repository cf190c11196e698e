#include "http/scan_view.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

Job current(Job stored, const Status& status) {
  if (status.job && status.job->id == stored.id) {
    Job job = *status.job;
    job.name = std::move(stored.name);
    return job;
  }
  if (stored.state == JobState::running) {
    stored.state = JobState::interrupted;  // by a process that could not even write that down
    stored.phase = Phase::done;
    stored.failure = interruption();
  }
  return stored;
}

}  // namespace

Job find_scan(const App& app, std::string_view id) {
  std::optional<Job> stored = app.store.find(id);
  if (!stored) {
    throw Error("no-such-scan", "there is no scan " + std::string(id),
                "GET /api/v1/scans lists them.");
  }
  return current(*std::move(stored), app.scanner.status());
}

std::vector<Job> all_scans(const App& app) {
  std::vector<Job> scans = app.store.list();
  const Status now = app.scanner.status();
  for (Job& job : scans) {
    job = current(std::move(job), now);
  }
  return scans;
}

std::optional<Job> running_scan(const App& app) {
  const Status now = app.scanner.status();
  std::optional<Job> stored;
  if (now.busy()) {
    stored = app.store.find(now.job->id);
  }
  return stored ? std::optional(current(*std::move(stored), now)) : std::nullopt;
}

nlohmann::json to_json(const App& app, const Job& job) {
  nlohmann::json scan = json_of(job);
  const auto preview = app.scanner.preview();
  scan["preview"] = nullptr;
  if (job.state == JobState::running && preview->id == job.id && preview->snapshots > 0) {
    scan["preview"] = {{"url", "/api/v1/scans/" + job.id + "/preview.stl"},
                       {"snapshots", preview->snapshots}};
  }
  return scan;
}

}  // namespace octurn
