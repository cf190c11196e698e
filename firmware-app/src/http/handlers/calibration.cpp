#include "http/handlers/calibration.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "calibration/board_pdf.hpp"
#include "calibration/lens_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/scan_of_rig.hpp"
#include "capture/wall_views.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/system.hpp"
#include "http/json_body.hpp"
#include "octurn/json_object.hpp"
#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"
#include "settings/pose_field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int point_step = 8;  // pixels: 80 x 60 points suffice to show the sensor's view

/// The configured and the calibrated lens of a camera with lasers; null for another sensor.
json lens_json(const App& app, const std::optional<KeptLens>& kept) {
  return app.rig.laser ? json{{"told", to_json(told_lens(*app.rig.laser))},
                              {"kept", kept ? to_json(*kept) : json()}}
                       : json();
}

/// The kept optics of a depth sensor: those in force, and the earlier ones, newest first; null if
/// there are none.
json optics_json(const std::vector<OpticsRecord>& records) {
  if (records.empty()) {
    return nullptr;
  }
  json object = to_json(records.front());
  object["history"] = json::array();
  for (std::size_t i = 1; i < records.size(); ++i) {
    object["history"].push_back(to_json(records[i]));
  }
  return object;
}

/// The serial number of the known camera with lasers; empty for another sensor.
std::string camera_serial(const App& app) {
  return app.rig.laser ? app.scanner.sensor_serial() : "";
}

Response send_calibration(App& app, int status) {
  std::vector<PoseRecord> records =
      app.scanner.calibration().records(app.settings.config().scan, camera_serial(app));
  json body = to_json(records.front());
  json history = json::array();
  for (std::size_t i = 1; i < records.size(); ++i) {
    history.push_back(to_json(records[i]));
  }
  const auto run = app.scanner.calibration_run();
  body["history"] = std::move(history);
  const auto sensor = app.scanner.known_sensor();
  const std::chrono::duration<double> open =
      std::chrono::steady_clock::now() - sensor->since.value_or(std::chrono::steady_clock::now());
  body["sensor_map"] = sensor->map ? to_json(*sensor->map) : json();
  body["sensor_on_s"] = sensor->since ? json(std::floor(open.count())) : json();
  body["lens"] = lens_json(app, sensor->lens);
  body["infrared"] = sensor->has_infrared;
  body["optics"] = optics_json(sensor->optics);
  body["run"] = *run ? to_json(**run) : json();
  return json_response(body, status);
}

[[noreturn]] void refuse_busy() {
  throw Error(ErrorCode::busy, "the scanner works already", "Wait for its end, or cancel it.");
}

/// @throws Error "bad-settings"
PoseChange to_change(JsonObject& keys) {
  PoseChange change{.scale = keys.number("scale", min_depth_scale, max_depth_scale)};
  if (const auto pose = keys.value("platform_from_sensor")) {
    change.is_settings_pose = pose->json().is_null();
    if (!change.is_settings_pose) {
      change.platform_from_sensor = to_pose(*pose);
    }
  }
  return change;
}

void start_turn(App& app, JsonObject& keys) {
  ScanSettings settings =
      app.scanner.calibration().in_force(app.settings.config().scan, camera_serial(app));
  settings.snapshots = keys.whole_number("stops", min_calibration_stops, max_calibration_stops)
                           .value_or(default_calibration_stops);
  keys.refuse_unread();
  expect_no_update(app);
  app.scanner.expect_ready();
  if (!app.scanner.calibrate(settings)) {
    refuse_busy();
  }
}

void start_wall(App& app, JsonObject& keys) {
  const int frames = keys.whole_number("frames", 1, max_wall_frames).value_or(default_wall_frames);
  keys.refuse_unread();
  expect_no_update(app);
  if (!app.scanner.look_at_wall(frames)) {
    refuse_busy();
  }
}

/// The change of the lens that a body asks for.
enum class LensChange { none, keep, discard, remove };

LensChange to_lens_change(JsonObject& keys) {
  const auto lens = keys.value("lens");
  if (!lens) {
    return LensChange::none;
  }
  if (lens->json() == "keep") {
    return LensChange::keep;
  }
  if (lens->json() == "discard") {
    return LensChange::discard;
  }
  if (!lens->json().is_null()) {
    lens->refuse("\"keep\" or \"discard\" for what was found, or null, which removes what is kept");
  }
  return LensChange::remove;
}

void carry_out(App& app, LensChange change) {
  switch (change) {
    case LensChange::keep:
      return app.scanner.keep_lens(app.settings.config().scan);
    case LensChange::discard:
      return app.scanner.discard_lens();
    case LensChange::remove:
      return app.scanner.forget_lens();
    case LensChange::none:
      break;
  }
}

void start_lens(App& app, JsonObject& keys) {
  const double square_mm =
      keys.number("square_mm", min_board_square_mm, max_board_square_mm).value_or(board_square_mm);
  keys.refuse_unread();
  expect_no_update(app);
  if (!app.scanner.look_at_board(metres_from_mm(square_mm))) {
    refuse_busy();
  }
}

/// @return whether the body has the key
/// @throws Error "bad-settings"  if its value is not null
bool has_null(JsonObject& keys, std::string_view key, const std::string& meaning) {
  const auto value = keys.value(key);
  if (value && !value->json().is_null()) {
    value->refuse("null, which " + meaning);
  }
  return value.has_value();
}

}  // namespace

Response send_calibration(App& app) { return send_calibration(app, 200); }

Response change_calibration(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const PoseChange change = to_change(keys);
  const bool forget_map = has_null(keys, "sensor_map", "removes it");
  const bool undo_optics = has_null(keys, "optics", "restores those before them");
  const LensChange lens = to_lens_change(keys);
  keys.refuse_unread();
  if (change.scale && app.rig.laser) {
    keys.at("scale").refuse("nothing of a rig with lasers: it measures no depth");
  }
  const bool is_change = change.scale || change.platform_from_sensor || change.is_settings_pose;
  if (!is_change && !forget_map && !undo_optics && lens == LensChange::none) {
    throw Error(ErrorCode::bad_settings, "the body changes nothing",
                "It takes platform_from_sensor, scale, sensor_map, optics and lens.");
  }
  // First what may be refused: there may be no earlier optics.
  if ((undo_optics && !app.scanner.undo_optics()) ||
      (forget_map && !app.scanner.forget_sensor_map())) {
    refuse_busy();
  }
  carry_out(app, lens);
  if (is_change) {
    app.scanner.calibration().change(change, app.settings.config().scan, camera_serial(app));
  }
  return send_calibration(app);
}

Response start_calibration(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const JsonValue kind = keys.at("kind");
  if (kind.text() == "turn") {
    start_turn(app, keys);
  } else if (kind.text() == "wall") {
    start_wall(app, keys);
  } else if (kind.text() == "lens") {
    start_lens(app, keys);
  } else {
    kind.refuse("\"turn\", \"wall\" or \"lens\"");
  }
  return send_calibration(app, 202);
}

Response cancel_calibration(App& app) {
  if (!app.scanner.cancel_calibration()) {
    throw Error(ErrorCode::not_running, "no calibration is running",
                "POST /api/v1/calibration begins one.");
  }
  return send_calibration(app, 202);
}

Response solve_lens(App& app) {
  if (!app.scanner.solve_lens()) {
    throw Error(ErrorCode::not_running, "no lens is being calibrated, or no board was seen yet",
                "POST /api/v1/calibration with the kind \"lens\" looks for a board.");
  }
  return send_calibration(app, 202);
}

Response send_board(App& /*app*/, const Request& request) {
  std::optional<Paper> paper = Paper::a4;
  for (const auto& [name, value] : request.parameters) {
    paper = name == "paper" ? paper_named(value) : std::nullopt;
  }
  if (!paper) {
    throw Error(ErrorCode::bad_settings, "there is no board for that paper",
                "Ask for paper=a4 or paper=letter.");
  }
  return {.headers = {{"Content-Type", "application/pdf"},
                      {"Content-Disposition", "inline; filename=\"octurn-board.pdf\""},
                      {"Cache-Control", "no-store"}},
          .body = board_pdf(*paper)};
}

Response undo_calibration(App& app) {
  app.scanner.calibration().undo(camera_serial(app));
  return send_calibration(app);
}

Response send_sensor_map(App& app) {
  const auto sensor = app.scanner.known_sensor();
  if (!sensor->map) {
    throw Error(ErrorCode::not_found, "this sensor has no map",
                "POST /api/v1/calibration with the kind \"wall\" makes one.");
  }
  return json_response(to_picture(*sensor->map));
}

Response send_points(App& app) {
  const auto camera = app.scanner.camera_frame();
  if (camera->picture.width > 0 && app.rig.laser) {
    throw Error(ErrorCode::not_found, "a camera with lasers measures no depth",
                "GET /api/v1/preview/depth.png shows what it sees.");
  }
  const auto sensor = app.scanner.known_sensor();
  const std::vector<OpticsRecord>& known = sensor->optics;
  const double scale = app.scanner.calibration().in_force(app.settings.config().scan).depth_scale;
  Intrinsics lens = scaled(camera->lens, scale);
  DepthFrame frame = camera->frame;
  if (!known.empty() && frame.width > 0) {  // none while a Kinect looks at a board
    frame = rectified(std::move(frame), lens, known.front().optics.value);
    lens = rectified(lens, known.front().optics.value);
  }
  const SensorTraits& traits = sensor_traits(sensor_name(app));
  json points = json::array();
  for (int v = 0; v < frame.height; v += point_step) {
    for (int u = 0; u < frame.width; u += point_step) {
      const auto pixel = static_cast<std::size_t>(v * frame.width + u);
      const double z = frame.depth[pixel] * lens.depth_unit;
      const auto mm = [](double metres) { return std::round(mm_from_metres(metres) * 10) / 10; };
      if (z > 0) {
        const Eigen::Vector3d point = z * pixel_ray(lens, u, v);
        points.push_back({mm(point.x()), mm(point.y()), mm(z)});
      }
    }
  }
  return json_response({{"sensor",
                         {{"width", lens.width},
                          {"height", lens.height},
                          {"fx", lens.fx},
                          {"fy", lens.fy},
                          {"cx", lens.cx},
                          {"cy", lens.cy},
                          {"nearest_m", traits.nearest},
                          {"best_m", {traits.best_near, traits.best_far}},
                          {"farthest_m", traits.farthest}}},
                        {"points_mm", std::move(points)}});
}

}  // namespace octurn
