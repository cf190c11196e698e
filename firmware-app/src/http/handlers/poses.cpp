#include "http/handlers/poses.hpp"

#include <charconv>
#include <nlohmann/json.hpp>
#include <string>

#include "build/pose_points.hpp"
#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/builds.hpp"
#include "http/json_body.hpp"
#include "http/scan_json.hpp"
#include "http/scan_view.hpp"
#include "store/pose_choice.hpp"

namespace octurn {
namespace {

/// Parses a pose's number; 0, which no pose has, if the text is no number.
int to_pose_number(std::string_view text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc() && read.ptr == end ? number : 0;
}

}  // namespace

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
