#include "http/scan_view.hpp"

#include <nlohmann/json.hpp>

#include "http/scan_json.hpp"

namespace octurn {

Job find_scan(const App& app, std::string_view id) { return app.scanner.find(id); }

std::vector<Job> all_scans(const App& app) { return app.scanner.list(); }

std::optional<Job> running_scan(const App& app) {
  const Status now = app.scanner.status();
  return now.is_scanning() ? now.job : std::nullopt;
}

nlohmann::json to_json(const App& app, const Job& job) {
  nlohmann::json scan = to_json(job);
  const auto preview = app.scanner.mesh_preview();
  scan["preview"] = nullptr;
  if (job.state == JobState::running && preview->id == job.id && preview->snapshots > 0) {
    scan["preview"] = {{"url", "/api/v1/scans/" + job.id + "/preview.stl"},
                       {"snapshots", preview->snapshots}};
  }
  return scan;
}

}  // namespace octurn
