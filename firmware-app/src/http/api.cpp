#include "http/api.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "doctor/diagnostics.hpp"
#include "http/file_response.hpp"
#include "http/json_body.hpp"
#include "http/preview_image.hpp"
#include "http/problem.hpp"
#include "http/same_origin.hpp"
#include "log.hpp"
#include "octurn/json_object.hpp"
#include "utc.hpp"
#include "version.hpp"
#include "zip_archive.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t longest_name = 100;  // of a scan, bytes
constexpr std::string_view update_path = "/api/v1/update";

[[noreturn]] void throw_busy() {
  throw Error("busy", "a scan is running", "Wait for its end, or cancel it.");
}

/// A scan as it is now: the one that was started last as the scanner has it, the others as stored.
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

/// Whether a path is as a route has it; `{id}` stands for any one part.
/// @return the part, empty if the route has none; nothing if they differ
std::optional<std::string_view> match(std::string_view route, std::string_view path) {
  constexpr std::string_view id = "{id}";
  const std::size_t at = route.find(id);
  if (at == std::string_view::npos) {
    return route == path ? std::optional<std::string_view>("") : std::nullopt;
  }
  const std::string_view rest = route.substr(at + id.size());
  if (path.size() <= at || path.substr(0, at) != route.substr(0, at)) {
    return std::nullopt;
  }
  const std::string_view part = path.substr(at, path.find('/', at) - at);
  return path.substr(at + part.size()) == rest ? std::optional(part) : std::nullopt;
}

}  // namespace

struct Api::Route {
  std::string_view method;
  std::string_view path;
  Response (Api::*handler)(const Request&, std::string_view id);
};

const std::vector<Api::Route>& Api::routes() {
  static const std::vector<Route> all{
      {"GET", "/Scan.stl", &Api::newest_model},
      {"GET", "/api/v1/status", &Api::status},
      {"GET", "/api/v1/settings", &Api::settings},
      {"GET", "/api/v1/doctor", &Api::doctor},
      {"GET", "/api/v1/diagnostics.zip", &Api::diagnostics},
      {"GET", "/api/v1/preview/depth.png", &Api::preview},
      {"GET", "/api/v1/scans", &Api::list},
      {"POST", "/api/v1/scans", &Api::start},
      {"GET", "/api/v1/scans/{id}", &Api::scan},
      {"PATCH", "/api/v1/scans/{id}", &Api::rename},
      {"DELETE", "/api/v1/scans/{id}", &Api::remove},
      {"POST", "/api/v1/scans/{id}/cancel", &Api::cancel},
      {"POST", "/api/v1/scans/{id}/resume", &Api::resume},
      {"GET", "/api/v1/scans/{id}/Scan.stl", &Api::model},
      {"GET", "/api/v1/scans/{id}/preview.stl", &Api::surface_so_far},
      {"GET", update_path, &Api::update},
      {"PUT", update_path, &Api::take_update},
      {"GET", "/api/v1/wifi", &Api::wifi},
      {"PUT", "/api/v1/wifi", &Api::join_wifi},
  };
  return all;
}

Api::Api(Scanner& scanner, const ScanStore& store, const Page& page, Patient patient,
         Appliance* appliance)
    : scanner_(scanner),
      store_(store),
      page_(page),
      patient_(std::move(patient)),
      appliance_(appliance) {}

Response Api::answer(const Request& request) {
  try {
    const std::string_view body_type =
        request.path == update_path ? upload_type : "application/json";
    const auto refused = refusal(request, patient_.config.host_names, body_type);
    return refused ? problem(*refused) : dispatch(request);
  } catch (const Error& error) {
    return problem(failure_of(error));
  } catch (const std::exception& error) {
    log::error("http", request.method + " " + request.path + ": " + error.what());
    return problem({.code = "internal", .detail = error.what(), .hint = "Please report this."});
  }
}

Response Api::dispatch(const Request& request) {
  const std::string_view method = request.is_read() ? std::string_view("GET") : request.method;
  std::string allowed;
  for (const Route& route : routes()) {
    const auto id = match(route.path, request.path);
    if (id && route.method == method) {
      return (this->*route.handler)(request, *id);
    }
    if (id) {
      allowed.append(allowed.empty() ? "" : ", ").append(route.method);
      allowed.append(route.method == "GET" ? ", HEAD" : "");
    }
  }
  if (allowed.empty() && request.is_read()) {
    return page_.file(request);
  }
  if (allowed.empty()) {
    throw Error("not-found", "there is no " + request.path, "web/API.md lists what there is.");
  }
  Response response = problem({.code = "wrong-method",
                               .detail = request.method + " is not for " + request.path,
                               .hint = "It takes " + allowed + "."});
  response.headers.emplace_back("Allow", allowed);
  return response;
}

Response Api::status(const Request& /*request*/, std::string_view /*id*/) {
  const std::optional<Job> newest = store_.newest_finished();
  const Status now = scanner_.status();
  json body{{"version", version()},
            {"sensor", json_of(now.sensor)},
            {"turntable", json_of(now.turntable)},
            {"disk_free_bytes", store_.free_bytes()},
            {"appliance", appliance_ != nullptr},
            {"scan", nullptr},
            {"newest", nullptr}};
  if (now.busy()) {
    if (const auto stored = store_.find(now.job->id)) {
      body["scan"] = described(current(*stored, now));
    }
  }
  if (newest) {
    body["newest"] = newest->id;
  }
  return json_response(body);
}

Response Api::settings(const Request& /*request*/, std::string_view /*id*/) {
  return json_response({{"defaults", json_of(patient_.config.scan)}});
}

Response Api::doctor(const Request& /*request*/, std::string_view /*id*/) {
  return json_response(json_of(examine(patient_, scanner_)));
}

Response Api::diagnostics(const Request& /*request*/, std::string_view /*id*/) {
  const std::vector<Finding> findings = examine(patient_, scanner_);
  const std::vector<Job> scans = scans_now();
  std::vector<ArchivedFile> files = diagnostics_of_machine(patient_.config, findings);
  std::ranges::move(diagnostics_of_daemon(scanner_.status(), scans, log::recent()),
                    std::back_inserter(files));
  if (appliance_ != nullptr) {
    std::ranges::move(diagnostics_of_appliance(*appliance_), std::back_inserter(files));
  }

  const auto time = std::chrono::system_clock::now();
  const std::string name = "octurn-diagnostics-" + utc_text(time, "%Y%m%d-%H%M%S") + ".zip";
  return {.headers = {{"Content-Type", "application/zip"},
                      {"Content-Disposition", attachment(name)},
                      {"Cache-Control", "no-store"}},
          .body = zip_of(files, time)};
}

Response Api::preview(const Request& /*request*/, std::string_view /*id*/) {
  const auto view = scanner_.view();
  return {.headers = {{"Content-Type", "image/png"}, {"Cache-Control", "no-store"}},
          .body = preview_png(view->frame, view->depth_unit)};
}

Response Api::list(const Request& /*request*/, std::string_view /*id*/) {
  json scans = json::array();
  for (const Job& job : scans_now()) {
    scans.push_back(described(job));
  }
  return json_response({{"scans", scans}});
}

Response Api::start(const Request& request, std::string_view /*id*/) {
  const ScanSettings settings = settings_from(body_of(request), patient_.config.scan);
  expect_no_update();
  scanner_.expect_ready();
  const std::optional<Job> job = scanner_.start(settings);
  if (!job) {
    throw_busy();
  }
  Response response = json_response(described(*job), 202);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job->id);
  return response;
}

Response Api::scan(const Request& /*request*/, std::string_view id) {
  return json_response(described(find(id)));
}

Response Api::rename(const Request& request, std::string_view id) {
  const json body = body_of(request);
  JsonObject keys(body, "bad-name", "");
  const auto name = keys.text("name");
  keys.refuse_unread();
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; };
  if (!name || name->size() > longest_name || std::ranges::any_of(*name, is_control)) {
    throw Error("bad-name", "\"name\" must be text of at most 100 bytes on one line");
  }
  store_.rename(id, *name);
  return json_response(described(find(id)));
}

Response Api::remove(const Request& /*request*/, std::string_view id) {
  if (find(id).state == JobState::running) {
    throw Error("busy", "this scan is running", "Cancel it first.");
  }
  store_.remove(id);
  return {.status = 204};
}

Response Api::cancel(const Request& /*request*/, std::string_view id) {
  const Job job = find(id);
  if (!scanner_.cancel(id)) {
    throw Error("not-running", "this scan is " + std::string(name_of(job.state)),
                "Only a scan that runs, or could be resumed, can be cancelled.");
  }
  return json_response(described(find(id)), 202);
}

Response Api::resume(const Request& /*request*/, std::string_view id) {
  const Job job = find(id);
  expect_no_update();
  if (is_resumable(job.state) && job.snapshots_done < job.settings.snapshots) {
    scanner_.expect_ready();
  }
  if (job.state == JobState::running || !scanner_.resume(id)) {
    throw_busy();
  }
  return json_response(described(find(id)), 202);
}

json Api::described(const Job& job) const {
  json scan = json_of(job);
  const auto preview = scanner_.preview();
  scan["preview"] = nullptr;
  if (job.state == JobState::running && preview->id == job.id && preview->snapshots > 0) {
    scan["preview"] = {{"url", "/api/v1/scans/" + job.id + "/preview.stl"},
                       {"snapshots", preview->snapshots}};
  }
  return scan;
}

Job Api::find(std::string_view id) const {
  std::optional<Job> stored = store_.find(id);
  if (!stored) {
    throw Error("no-such-scan", "there is no scan " + std::string(id),
                "GET /api/v1/scans lists them.");
  }
  return current(*std::move(stored), scanner_.status());
}

std::vector<Job> Api::scans_now() const {
  std::vector<Job> scans = store_.list();
  const Status now = scanner_.status();
  for (Job& job : scans) {
    job = current(std::move(job), now);
  }
  return scans;
}

}  // namespace octurn
