#include "http/handlers/builds.hpp"

#include <charconv>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "build/merged_scan.hpp"
#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/models.hpp"
#include "http/json_body.hpp"
#include "http/scan_json.hpp"
#include "http/scan_view.hpp"
#include "store/pose_choice.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json make_builds_json(const App& app, std::string_view id) {
  // Read before the scan: a build that ends in between is then in both, and not in neither.
  const std::vector<BuildRun> runs = app.scanner.build_runs();
  return builds_json(find_scan(app, id), runs);
}

/// The build of that number in a path. @throws Error "no-model"  if there is none
json find_build(const App& app, std::string_view id, std::string_view number) {
  for (json& build : make_builds_json(app, id)) {
    if (std::to_string(build["build"].get<int>()) == number) {
      return std::move(build);
    }
  }
  throw Error(ErrorCode::no_model, "this scan has no build " + std::string(number),
              "GET /api/v1/scans/ID/builds lists its builds.");
}

int parse_build_number(const json& build) { return build["build"].get<int>(); }

/// Removes the key `choose`, which is not a setting, from a body. @return its value
bool take_choice(json& body) {
  if (!body.is_object() || !body.contains("choose")) {
    return false;
  }
  const bool chooses = JsonValue(body["choose"], "choose", ErrorCode::bad_settings).flag();
  body.erase("choose");
  return chooses;
}

/// Parses a pose's number; 0, which no pose has, if the text is no number.
int to_pose_number(std::string_view text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc() && read.ptr == end ? number : 0;
}

}  // namespace

Response list_builds(App& app, std::string_view id) {
  return json_response({{"builds", make_builds_json(app, id)}});
}

Response start_build(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  json body = parse_body(request);
  const bool becomes_model = take_choice(body);
  const BuildOrder order{.settings = build_settings_from(body, {.scan = job.settings}),
                         .becomes_model = becomes_model};
  expect_no_update(app);
  return send_begun(app.scanner.build(id, order));
}

Response send_begun(const std::optional<BuildRun>& run) {
  if (!run) {
    throw Error(ErrorCode::busy, "a scan is running, or another model is being built",
                "Wait for its end, or cancel it.");
  }
  Response response = json_response(to_json(*run), 202);
  response.headers.emplace_back(
      "Location", "/api/v1/scans/" + run->scan + "/builds/" + std::to_string(run->number));
  return response;
}

Response send_build(App& app, std::string_view id, std::string_view build) {
  return json_response(find_build(app, id, build));
}

Response cancel_build(App& app, std::string_view id, std::string_view build) {
  const json found = find_build(app, id, build);
  if (!app.scanner.cancel_build(id, parse_build_number(found))) {
    throw Error(ErrorCode::not_running, "this build is " + found["state"].get<std::string>(),
                "Only a build that goes on can be cancelled.");
  }
  return json_response(find_build(app, id, build), 202);
}

Response choose_build(App& app, std::string_view id, std::string_view build) {
  app.scanner.choose_build(id, parse_build_number(find_build(app, id, build)));
  return json_response(to_json(app, find_scan(app, id)));
}

Response remove_build(App& app, std::string_view id, std::string_view build) {
  app.scanner.remove_build(id, parse_build_number(find_build(app, id, build)));
  return {.status = 204};
}

std::filesystem::path find_build_model(const App& app, std::string_view id,
                                       std::string_view build) {
  const json found = find_build(app, id, build);
  if (found["model"].is_null()) {
    throw Error(ErrorCode::no_model, "this build is " + found["state"].get<std::string>(),
                "Only a finished one has a model.");
  }
  return app.store.model_file(id, parse_build_number(found));
}

Response send_build_model(App& app, const Request& request, std::string_view id,
                          std::string_view build) {
  refuse_colours(request);
  const std::string name =
      download_name(find_scan(app, id), "-" + std::string(build).append(".stl"));
  return file_response(request, find_build_model(app, id, build), "model/stl", name);
}

Response list_poses(App& app, std::string_view id) {
  find_scan(app, id);  // throws if there is no such scan
  return json_response({{"poses", poses_json(app.scanner.poses(id))}});
}

Response start_pose(App& app, const Request& request, std::string_view id) {
  const Job first = find_scan(app, id);
  ScanSettings defaults = app.scanner.calibration().in_force(first.settings);
  defaults.depth_scale = first.settings.depth_scale;  // both are merged: they need one scale
  const ScanSettings settings = settings_from(parse_body(request), defaults);
  expect_no_update(app);
  app.scanner.expect_ready();
  const std::optional<Job> job = app.scanner.start_pose(id, settings);
  if (!job) {
    throw Error(ErrorCode::busy, "a scan is running, or the sensor's pose is measured",
                "Wait for its end, or cancel it.");
  }
  Response response = json_response(to_json(app, *job), 202);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job->id);
  return response;
}

Response choose_pose(App& app, const Request& request, std::string_view id,
                     std::string_view number) {
  const PoseChoice choice =
      pose_choice_from(parse_body(request), app.scanner.find_pose(id, to_pose_number(number)));
  expect_no_update(app);
  return send_begun(app.scanner.choose_pose(id, to_pose_number(number), choice));
}

Response send_pose_points(App& app, const Request& request, std::string_view id,
                          std::string_view number) {
  const Job pose = app.scanner.find_pose(id, to_pose_number(number));
  return file_response(request, app.store.folder(pose.id) / pose_points_file, "application/json",
                       "points.json");
}

Response remove_pose(App& app, std::string_view id, std::string_view number) {
  app.scanner.remove_pose(id, to_pose_number(number));
  return json_response(to_json(app, find_scan(app, id)));
}

}  // namespace octurn
