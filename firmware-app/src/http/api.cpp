#include "http/api.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "http/file_response.hpp"
#include "http/preview_image.hpp"
#include "http/problem.hpp"
#include "http/same_origin.hpp"
#include "json_object.hpp"
#include "log.hpp"
#include "scan/model_stream.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t longest_name = 100;  // of a scan, bytes

Response json_response(const json& body, int status = 200) {
  return {.status = status,
          .headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}},
          .body = body.dump(-1, ' ', false, json::error_handler_t::replace) + "\n"};
}

json json_of(const DeviceStatus& device) {
  constexpr std::array<std::string_view, 3> states{"ready", "missing", "failed"};
  return {{"state", states[static_cast<std::size_t>(device.state)]},
          {"name", device.name},
          {"simulated", device.simulated},
          {"message", device.message}};
}

json body_of(const Request& request) {
  return request.body.empty() ? json::object() : parse_json(request.body, "bad-json", "the body");
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

/// What a query says, "leaf_size_mm=0.5&level=7": numbers by name.
json numbers_from(std::string_view query) {
  json numbers = json::object();
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(part.size() + 1, query.size()));
    const std::size_t equals = part.find('=');
    const std::string name(part.substr(0, equals));
    const json value = equals == std::string_view::npos
                           ? json()
                           : json::parse(part.substr(equals + 1), nullptr, false);
    if (!value.is_number() || !numbers.emplace(name, value).second) {
      throw Error("bad-settings", "the query must give each setting once, as a number",
                  "Such as ?leaf_size_mm=0.5&level=7.");
    }
  }
  return numbers;
}

std::string file_name(const Job& job) { return (job.name.empty() ? "Scan" : job.name) + ".stl"; }

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
      {"GET", "/api/v1/preview/depth.png", &Api::preview},
      {"GET", "/api/v1/scans", &Api::list},
      {"POST", "/api/v1/scans", &Api::start},
      {"GET", "/api/v1/scans/{id}", &Api::scan},
      {"PATCH", "/api/v1/scans/{id}", &Api::rename},
      {"DELETE", "/api/v1/scans/{id}", &Api::remove},
      {"POST", "/api/v1/scans/{id}/cancel", &Api::cancel},
      {"GET", "/api/v1/scans/{id}/Scan.stl", &Api::model},
      {"GET", "/api/v1/scans/{id}/preview.stl", &Api::surface_so_far},
  };
  return all;
}

Api::Api(Scanner& scanner, const ScanStore& store, const Page& page, ApiOptions options)
    : scanner_(scanner), store_(store), page_(page), options_(std::move(options)) {}

Response Api::answer(const Request& request) noexcept {
  try {
    const auto refused = refusal(request, options_.host_names);
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
  return json_response({{"defaults", json_of(options_.defaults)}});
}

Response Api::doctor(const Request& /*request*/, std::string_view /*id*/) {
  return json_response(octurn::json_of(examine(options_.patient, scanner_)));
}

Response Api::preview(const Request& /*request*/, std::string_view /*id*/) {
  const auto view = scanner_.view();
  return {.headers = {{"Content-Type", "image/png"}, {"Cache-Control", "no-store"}},
          .body = preview_png(view->frame, view->depth_unit)};
}

Response Api::newest_model(const Request& request, std::string_view /*id*/) {
  const std::optional<Job> newest = store_.newest_finished();
  if (!newest) {
    throw Error("no-model", "no scan is finished yet", "Start a scan and wait for its end.");
  }
  return file_response(request, store_.model_file(newest->id), "model/stl", "Scan.stl");
}

Response Api::list(const Request& /*request*/, std::string_view /*id*/) {
  json scans = json::array();
  const std::vector<Job> stored = store_.list();
  const Status now = scanner_.status();
  for (const Job& job : stored) {
    scans.push_back(described(current(job, now)));
  }
  return json_response({{"scans", scans}});
}

Response Api::start(const Request& request, std::string_view /*id*/) {
  const ScanSettings settings = settings_from(body_of(request), options_.defaults);
  const Status now = scanner_.status();
  if (!now.busy() && now.sensor.state != DeviceStatus::State::ready) {
    scanner_.view();  // it may work again; if not, this says why
  }
  const std::optional<Job> job = scanner_.start(settings);
  if (!job) {
    throw Error("busy", "a scan is running", "Wait for its end, or cancel it.");
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
                "Only a running scan can be cancelled.");
  }
  return json_response(described(find(id)), 202);
}

Response Api::model(const Request& request, std::string_view id) {
  const Job job = find(id);
  if (!request.query.empty()) {
    return made_model(request, job);
  }
  if (job.state != JobState::finished) {
    throw Error("no-model", "this scan is " + std::string(name_of(job.state)) + ": it has no model",
                "Only a finished scan has one.");
  }
  return file_response(request, store_.model_file(id), "model/stl", file_name(job));
}

Response Api::made_model(const Request& request, const Job& job) {
  json numbers = numbers_from(request.query);
  std::optional<int> level;
  if (const auto given = numbers.find("level"); given != numbers.end()) {
    level = JsonObject(numbers, "bad-settings", "").whole_number("level", 0, Octree::max_levels);
    numbers.erase(given);
  }
  for (const auto& [name, value] : numbers.items()) {
    if (name != "leaf_size_mm") {
      throw Error("bad-settings", "the query has \"" + name + "\"",
                  "It takes leaf_size_mm and level.");
    }
  }
  ReconstructOptions options =
      reconstruct_options(settings_from(numbers, job.settings), options_.limits);
  options.level = level;
  if (job.state != JobState::running && job.snapshots_done == 0) {
    throw Error("no-model", "this scan has no snapshots", "Start a new scan.");
  }
  auto leave = scanner_.leave_to_reconstruct();
  if (!leave) {
    throw Error("busy", "a scan is running, or another model is being made", "Wait for its end.");
  }
  auto model = std::make_unique<ModelStream>(store_.folder(job.id), options, std::move(leave));
  const std::uint64_t bytes = model->bytes();
  ByteStream stream{.length = bytes};
  stream.make = std::packaged_task<void(const ByteSink&)>(
      [made = std::move(model), id = job.id](const ByteSink& sink) {
        try {
          made->send(sink);
        } catch (const std::exception& error) {
          log::error("http", "model of scan " + id + ": " + error.what());
        }
      });
  return {.headers = {{"Content-Type", "model/stl"},
                      {"Content-Disposition", attachment(file_name(job))},
                      {"Accept-Ranges", "none"},
                      {"Cache-Control", "no-store"}},
          .body = std::move(stream)};
}

Response Api::surface_so_far(const Request& request, std::string_view id) {
  find(id);  // or there is no such scan
  const auto preview = scanner_.preview();
  if (preview->id != id || preview->snapshots == 0) {
    throw Error("no-preview", "there is nothing of this scan to show",
                "Only the latest scan has a preview, from its first snapshot on.");
  }
  const std::string tag = '"' + preview->id + '-' + std::to_string(preview->snapshots) + '"';
  Headers headers{{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (const auto known = request.header("If-None-Match"); known && has_tag(*known, tag)) {
    return {.status = 304, .headers = std::move(headers)};
  }
  headers.emplace_back("Content-Type", "model/stl");
  return {.headers = std::move(headers), .body = preview->stl};
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

}  // namespace octurn
