#include "calibration/pose_record.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/units.hpp"
#include "settings/pose_field.hpp"
#include "settings/scan_settings.hpp"
#include "store/job_json.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

using Name = std::pair<PoseOrigin, std::string_view>;

constexpr std::array<Name, 5> origin_names{{{PoseOrigin::drawing, "default"},
                                            {PoseOrigin::settings, "settings"},
                                            {PoseOrigin::page, "page"},
                                            {PoseOrigin::turn, "turn"},
                                            {PoseOrigin::scan, "scan"}}};

PoseOrigin to_origin(const JsonValue& name) {
  const auto* const found = std::ranges::find(origin_names, name.text(), &Name::second);
  if (found == origin_names.end()) {
    name.refuse("a name that this version knows");
  }
  return found->first;
}

std::optional<PoseFigures> to_figures(JsonObject& keys) {
  if (keys.at("sigma_mm").json().is_null()) {
    return std::nullopt;
  }
  const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
  const auto radians = [&](std::string_view key) {
    return radians_from_degrees(keys.at(key).number());
  };
  return PoseFigures{.shift = metres("shift_mm"),
                     .tilt = radians("tilt_deg"),
                     .position_sigma = metres("sigma_mm"),
                     .direction_sigma = radians("sigma_deg"),
                     .before = metres("before_mm"),
                     .after = metres("after_mm")};
}

}  // namespace

std::string_view to_string(PoseOrigin origin) {
  return std::ranges::find(origin_names, origin, &Name::first)->second;
}

PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, double scale) {
  return {.platform_from_sensor = report.platform_from_sensor,
          .origin = origin,
          .at = utc_text(std::chrono::system_clock::now(), rfc3339),
          .figures = PoseFigures{.shift = report.shift,
                                 .tilt = report.tilt,
                                 .position_sigma = report.position_sigma,
                                 .direction_sigma = report.direction_sigma,
                                 .before = report.before,
                                 .after = report.after},
          .scale = scale};
}

PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, std::string camera,
                     std::vector<Laser> lasers) {
  PoseRecord record = to_record(report, origin, 1);
  record.camera = std::move(camera);
  record.lasers = std::move(lasers);
  return record;
}

json to_json(const PoseRecord& record) {
  const auto figure = [&](double (*unit)(double), double PoseFigures::*member) {
    return record.figures ? json(unit((*record.figures).*member)) : json();
  };
  json object{{"platform_from_sensor", to_rows(record.platform_from_sensor)},
              {"source", to_string(record.origin)},
              {"at", record.at.empty() ? json() : json(record.at)},
              {"shift_mm", figure(mm_from_metres, &PoseFigures::shift)},
              {"tilt_deg", figure(degrees_from_radians, &PoseFigures::tilt)},
              {"sigma_mm", figure(mm_from_metres, &PoseFigures::position_sigma)},
              {"sigma_deg", figure(degrees_from_radians, &PoseFigures::direction_sigma)},
              {"before_mm", figure(mm_from_metres, &PoseFigures::before)},
              {"after_mm", figure(mm_from_metres, &PoseFigures::after)},
              {"scale", record.scale}};
  if (!record.camera.empty()) {
    object["camera"] = record.camera;
    object["lasers"] = planes_to_json(record.lasers);
  }
  if (!record.optics_of.empty()) {
    object["optics_of"] = record.optics_of;
    object["optics_at"] = record.optics_at;
  }
  return object;
}

PoseRecord to_record(const JsonValue& object) {
  JsonObject keys(object);
  const JsonValue at = keys.at("at");
  const auto camera = keys.value("camera");
  return {.platform_from_sensor = to_pose(keys.at("platform_from_sensor")),
          .origin = to_origin(keys.at("source")),
          .at = at.json().is_null() ? std::string() : at.text(),
          .figures = to_figures(keys),
          .scale = keys.at("scale").number(min_depth_scale, max_depth_scale),
          .camera = camera ? camera->text() : std::string(),
          .lasers = camera ? to_planes(keys.at("lasers")) : std::vector<Laser>(),
          .optics_of = keys.text("optics_of").value_or(""),
          .optics_at = keys.text("optics_at").value_or("")};
}

}  // namespace octurn
