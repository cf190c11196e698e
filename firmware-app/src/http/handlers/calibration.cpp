#include "http/handlers/calibration.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "http/handlers/appliance.hpp"
#include "http/json_body.hpp"
#include "octurn/json_object.hpp"
#include "octurn/units.hpp"
#include "scan/depth_scale.hpp"
#include "scan/pose_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int point_step = 8;  // pixels: 80 x 60 points show where the sensor looks

Response send_calibration(App& app, int status) {
  std::vector<PoseRecord> records = app.scanner.calibration().records(app.settings.config().scan);
  json body = to_json(records.front());
  json history = json::array();
  for (std::size_t i = 1; i < records.size(); ++i) {
    history.push_back(to_json(records[i]));
  }
  const auto run = app.scanner.calibration_run();
  body["history"] = std::move(history);
  body["sensor_map"] = nullptr;
  body["run"] = *run ? to_json(**run) : json();
  return json_response(body, status);
}

/// @throws Error "bad-settings"
PoseChange to_change(const json& body) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  PoseChange change{.scale = keys.number("scale", min_depth_scale, max_depth_scale)};
  if (const auto pose = keys.value("platform_from_sensor")) {
    change.is_settings_pose = pose->json().is_null();
    if (!change.is_settings_pose) {
      change.platform_from_sensor = to_pose(*pose);
    }
  }
  keys.refuse_unread();
  if (!change.scale && !change.platform_from_sensor && !change.is_settings_pose) {
    throw Error(ErrorCode::bad_settings, "the body changes nothing",
                "It takes platform_from_sensor and scale.");
  }
  return change;
}

void start_turn(App& app, JsonObject& keys) {
  ScanSettings settings = app.scanner.calibration().in_force(app.settings.config().scan);
  settings.snapshots = keys.whole_number("stops", min_calibration_stops, max_calibration_stops)
                           .value_or(default_calibration_stops);
  keys.refuse_unread();
  expect_no_update(app);
  app.scanner.expect_ready();
  if (!app.scanner.calibrate(settings)) {
    throw Error(ErrorCode::busy, "the scanner works already", "Wait for its end, or cancel it.");
  }
}

}  // namespace

Response send_calibration(App& app) { return send_calibration(app, 200); }

Response change_calibration(App& app, const Request& request) {
  app.scanner.calibration().change(to_change(parse_body(request)), app.settings.config().scan);
  return send_calibration(app);
}

Response start_calibration(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const JsonValue kind = keys.at("kind");
  if (kind.text() == "turn") {
    start_turn(app, keys);
  } else {
    kind.refuse("\"turn\"");
  }
  return send_calibration(app, 202);
}

Response cancel_calibration(App& app) {
  if (!app.scanner.cancel_calibration()) {
    throw Error(ErrorCode::not_running, "no measurement of the pose goes on",
                "POST /api/v1/calibration begins one.");
  }
  return send_calibration(app, 202);
}

Response undo_calibration(App& app) {
  app.scanner.calibration().undo();
  return send_calibration(app);
}

Response send_points(App& app) {
  const auto camera = app.scanner.camera_frame();
  const double scale = app.scanner.calibration().in_force({}).depth_scale;
  const Intrinsics lens = scaled(camera->lens, scale);
  json points = json::array();
  for (int v = 0; v < camera->frame.height; v += point_step) {
    for (int u = 0; u < camera->frame.width; u += point_step) {
      const auto pixel = static_cast<std::size_t>(v * camera->frame.width + u);
      const double z = camera->frame.depth[pixel] * lens.depth_unit;
      const auto mm = [](double metres) { return std::round(mm_from_metres(metres) * 10) / 10; };
      if (z > 0) {
        points.push_back({mm(z * (u - lens.cx) / lens.fx), mm(z * (v - lens.cy) / lens.fy), mm(z)});
      }
    }
  }
  return json_response({{"sensor",
                         {{"width", lens.width},
                          {"height", lens.height},
                          {"fx", lens.fx},
                          {"fy", lens.fy},
                          {"cx", lens.cx},
                          {"cy", lens.cy}}},
                        {"points_mm", std::move(points)}});
}

}  // namespace octurn
