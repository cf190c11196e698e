#include "http/handlers/system.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>

#include "doctor/diagnostics.hpp"
#include "http/file_response.hpp"
#include "http/json_body.hpp"
#include "http/preview_image.hpp"
#include "http/scan_json.hpp"
#include "http/scan_view.hpp"
#include "log.hpp"
#include "utc.hpp"
#include "version.hpp"
#include "zip_archive.hpp"

namespace octurn {

using nlohmann::json;

json status_json(const App& app) {
  const std::optional<Job> newest = app.store.newest_finished();
  const std::optional<Job> running = running_scan(app);
  const Status now = app.scanner.status();
  const auto machine = app.machine.health();
  json body{{"version", version()},
            {"sensor", to_json(now.sensor)},
            {"turntable", to_json(now.turntable)},
            {"disk_free_bytes", machine->disk_free_bytes},
            {"appliance", app.appliance != nullptr},
            {"warnings", to_json(machine->warnings).at("findings")},
            {"scan", nullptr},
            {"build", nullptr},
            {"cluster_builds", nullptr},
            {"newest", nullptr},
            {"scans_revision", app.store.revision()}};
  if (running) {
    body["scan"] = to_json(app, *running);
  }
  if (const auto build = app.scanner.build_run(); *build) {
    body["build"] = to_json(**build);
  }
  if (const auto elsewhere = app.scanner.slurm_runs()) {
    body["cluster_builds"] = json::array();
    for (const BuildRun& run : *elsewhere) {
      body["cluster_builds"].push_back(to_json(run));
    }
  }
  if (newest) {
    body["newest"] = newest->id;
  }
  return body;
}

Response send_status(App& app) { return json_response(status_json(app)); }

Response send_description(App& app, const Request& request) {
  Request file = request;
  file.path = "/openapi.json";
  return app.page.file(file);
}

Response send_findings(App& app) {
  return json_response(to_json(run_checks(app.doctor_input(), app.scanner)));
}

Response send_diagnostics(App& app) {
  const std::vector<Finding> findings = run_checks(app.doctor_input(), app.scanner);
  const std::vector<Job> scans = all_scans(app);
  std::vector<ArchivedFile> files = machine_diagnostics(app.settings.config(), findings);
  files.push_back(calibration_diagnostics(app.settings.config()));
  std::ranges::move(daemon_diagnostics(app.scanner.status(), scans, log::recent()),
                    std::back_inserter(files));
  if (app.appliance != nullptr) {
    std::ranges::move(appliance_diagnostics(*app.appliance), std::back_inserter(files));
  }

  const auto time = std::chrono::system_clock::now();
  const std::string name = "octurn-diagnostics-" + utc_text(time, "%Y%m%d-%H%M%S") + ".zip";
  return {.headers = {{"Content-Type", "application/zip"},
                      {"Content-Disposition", attachment(name)},
                      {"Cache-Control", "no-store"}},
          .body = make_zip(files, time)};
}

Response send_depth_picture(App& app) {
  const auto camera = app.scanner.camera_frame();
  return {.headers = {{"Content-Type", "image/png"}, {"Cache-Control", "no-store"}},
          .body = camera->picture.width > 0 ? preview_png(camera->picture)
                                            : preview_png(camera->frame, camera->lens.depth_unit)};
}

}  // namespace octurn
