#include "http/scan_view.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <utility>

#include "http/scan_json.hpp"

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

}  // namespace octurn
