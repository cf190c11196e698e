#include "http/scan_view.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <span>
#include <unordered_map>
#include <utility>

#include "doctor/finding.hpp"
#include "http/json_body.hpp"
#include "http/scan_json.hpp"
#include "process.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A scan as in web/API.md, without its other poses.
json with_preview(const App& app, const Job& job) {
  json scan = to_json(job);
  const auto preview = app.scanner.mesh_preview();
  scan["can_resume"] = app.scanner.can_resume(job);
  scan["preview"] = nullptr;
  if (job.state == JobState::running && preview->id == job.id && preview->snapshots > 0) {
    scan["preview"] = {{"url", "/api/v1/scans/" + job.id + "/preview.stl"},
                       {"snapshots", preview->snapshots}};
  }
  return scan;
}

}  // namespace

Job find_scan(const App& app, std::string_view id) { return app.scanner.find(id); }

std::vector<Job> all_scans(const App& app) { return app.scanner.list(); }

std::optional<Job> running_scan(const App& app) { return app.scanner.running(); }

json to_json(const App& app, const Job& job) {
  json scan = with_preview(app, job);
  scan["poses"] = poses_json(app.scanner.poses(job.id));
  return scan;
}

void for_each_scan(const App& app, const std::function<void(json)>& show) {
  const std::vector<Job> jobs = app.scanner.list();
  std::unordered_map<std::string, std::vector<Job>> poses;  // by the first scan; oldest first
  for (const Job& job : jobs) {
    if (job.pose_of) {
      auto& of_scan = poses[job.pose_of->scan];
      of_scan.insert(of_scan.begin(), job);
    }
  }
  for (const Job& job : jobs) {
    json scan = with_preview(app, job);
    const auto of_job = poses.find(job.id);
    scan["poses"] = of_job == poses.end() ? json::array() : poses_json(of_job->second);
    show(std::move(scan));
  }
}

namespace {

WebhookEvent make_event(const std::string& name, const char* key, const json& about) {
  json body{{"event", name},
            {"scanner", host_name()},
            {"time", utc_text(std::chrono::system_clock::now(), rfc3339)}};
  if (key != nullptr) {
    body[key] = about;
  }
  return {.name = name, .body = json_text(body)};
}

/// The webhook event of a state; empty if there is none.
std::string to_event_name(JobState state) {
  switch (state) {
    case JobState::running:
      return "scan-started";
    case JobState::paused:
      return "scan-paused";
    case JobState::finished:
      return "scan-finished";
    case JobState::failed:
      return "scan-failed";
    case JobState::cancelled:
      return "scan-cancelled";
    case JobState::interrupted:
      break;  // the program has ended, and sends nothing
  }
  return "";
}

/// A scan whose outcome could not be saved, such as on a full disk, waits for a person like one
/// that is paused.
JobState to_reported_state(const Job& job) {
  const bool waits = job.state == JobState::interrupted && job.failure &&
                     job.failure->code != ErrorCode::interrupted;
  return waits ? JobState::paused : job.state;
}

}  // namespace

std::vector<ScanEvent> changes(const ScanStates& before, const ScanStates& now,
                               const std::string& newest) {
  std::vector<ScanEvent> events;
  for (const auto& [id, state] : now) {
    const auto earlier = before.find(id);
    const bool is_news = earlier != before.end() ? earlier->second != state : id > newest;
    if (const std::string event = to_event_name(state); is_news && !event.empty()) {
      events.push_back({.event = event, .id = id});
    }
  }
  return events;
}

std::vector<ScanEvent> ScanNews::next_scans(const App& app) {
  const Status status = app.scanner.status();
  Mark mark{app.store.revision(), status.job ? status.job->id : "",
            status.job ? status.job->state : JobState::finished};
  if (mark == mark_) {
    return {};
  }
  ScanStates now;
  for (const Job& job : all_scans(app)) {
    now.emplace(job.id, to_reported_state(job));
  }
  std::vector<ScanEvent> events;
  if (mark_) {
    events = changes(states_, now, newest_);
  }
  mark_ = std::move(mark);
  states_ = std::move(now);
  if (!states_.empty()) {
    newest_ = std::max(newest_, states_.rbegin()->first);
  }
  return events;
}

std::vector<WebhookEvent> ScanNews::next_warnings(const App& app) {
  if (app.addresses.webhooks().empty()) {  // no receiver: warnings are not tracked
    warnings_.reset();
    return {};
  }
  std::vector<WebhookEvent> events;
  std::set<std::string> now;
  const auto health = app.machine.health();
  for (const Finding& warning : health->warnings) {
    now.insert(warning.check);
    if (warnings_ && !warnings_->contains(warning.check)) {
      events.push_back(
          make_event("warning", "warning", to_json(std::span(&warning, 1)).at("findings").at(0)));
    }
  }
  warnings_ = std::move(now);
  return events;
}

std::vector<WebhookEvent> ScanNews::next(const App& app) {
  std::vector<WebhookEvent> events = next_warnings(app);
  for (const ScanEvent& event : next_scans(app)) {
    events.push_back(make_event(event.event, "scan", to_json(app, find_scan(app, event.id))));
  }
  return events;
}

WebhookEvent make_test_event() { return make_event("test", nullptr, {}); }

}  // namespace octurn
