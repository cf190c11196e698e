#include "http/handlers/system.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "doctor/diagnostics.hpp"
#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/json_body.hpp"
#include "http/scan_json.hpp"
#include "http/scan_view.hpp"
#include "log.hpp"
#include "version.hpp"
#include "wall_clock.hpp"
#include "zip_file.hpp"

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

std::string sensor_name(const App& app) { return app.scanner.latest_status()->sensor.name; }

Response send_depth_picture(App& app) {
  const auto camera = app.scanner.camera_frame();
  return {.headers = {{"Content-Type", "image/png"}, {"Cache-Control", "no-store"}},
          .body = camera->picture.width > 0 ? preview_png(camera->picture)
                                            : preview_png(camera->frame, camera->lens.depth_unit,
                                                          sensor_traits(sensor_name(app)))};
}

namespace {

constexpr std::size_t max_lines = 200;

/// The last `max_lines` lines of a text.
json last_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  const std::size_t skipped = lines.size() - std::min(lines.size(), max_lines);
  return std::vector(lines.begin() + static_cast<std::ptrdiff_t>(skipped), lines.end());
}

/// Whether the machine's health checks warn about the clock, so that it may be set.
bool is_clock_doubtful(const App& app) {
  const auto health = app.machine.health();
  return std::ranges::count(health->warnings, "clock", &Finding::check) > 0;
}

Response end_machine(App& app, PowerEnd end) {
  Appliance& machine = expect_appliance(app);
  expect_no_update(app);
  if (app.scanner.is_busy()) {
    throw Error(ErrorCode::busy, "a scan is running, a model is built, or the pose is measured",
                "Pause the scan, or wait for the end.");
  }
  machine.ask_for_control(end);
  log::info("appliance", end == PowerEnd::restart ? "the page asks for a restart"
                                                  : "the page asks to shut down");
  return json_response(json::object(), 202);
}

}  // namespace

Response set_clock(App& app, const Request& request) {
  Appliance& machine = expect_appliance(app);
  const auto time = clock_from(parse_body(request));
  if (!is_clock_doubtful(app)) {
    throw Error(ErrorCode::bad_settings, "the clock is right: a time server has set it",
                "There is nothing to do.");
  }
  machine.ask_for_control(time);
  log::info("appliance", "the page sets the clock");
  return json_response(json::object(), 202);
}

Response restart_machine(App& app) { return end_machine(app, PowerEnd::restart); }

Response shut_machine_down(App& app) { return end_machine(app, PowerEnd::off); }

Response send_messages(App& app) {
  return json_response(
      {{"log", last_lines(log::recent())},
       {"errors", last_lines(app.appliance != nullptr ? app.appliance->errors() : "")}});
}

namespace {

constexpr int width = 320;
constexpr int height = 240;

// Brightness is linear in inverse depth, as the sensor's resolution is. Some readings are nearer
// than the sensor's range: a Kinect v1's from 0.45 m; 2 m is behind any platform.
constexpr double near_share = 0.9;
constexpr double max_depth = 2.0;      // metres
constexpr double min_brightness = 24;  // distinguishes far from no reading

std::uint8_t to_brightness(double depth, double min_depth) {
  if (depth <= 0) {
    return 0;
  }
  const double share = (1 / depth - 1 / max_depth) / (1 / min_depth - 1 / max_depth);
  return static_cast<std::uint8_t>(
      std::lround(min_brightness + (255 - min_brightness) * std::clamp(share, 0.0, 1.0)));
}

/// @param brightness  of a sample by its index
template <typename Brightness>
std::string sampled_png(int from_width, int from_height, Brightness brightness) {
  std::vector<std::uint8_t> picture;
  picture.reserve(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    const int row = y * from_height / height * from_width;
    for (int x = 0; x < width; ++x) {
      picture.push_back(brightness(static_cast<std::size_t>(row + x * from_width / width)));
    }
  }
  const std::vector<std::byte> png = encode_grey_png(width, height, picture);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

}  // namespace

std::string preview_png(const DepthFrame& frame, double depth_unit, const SensorTraits& sensor) {
  return sampled_png(frame.width, frame.height, [&](std::size_t sample) {
    return to_brightness(frame.depth[sample] * depth_unit, near_share * sensor.nearest);
  });
}

std::string preview_png(const Picture& picture) {
  return sampled_png(picture.width, picture.height,
                     [&](std::size_t sample) { return picture.samples[sample]; });
}

}  // namespace octurn
