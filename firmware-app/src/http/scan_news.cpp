#include "http/scan_news.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "doctor/finding.hpp"
#include "host_name.hpp"
#include "http/json_body.hpp"
#include "http/scan_view.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

using nlohmann::json;

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
