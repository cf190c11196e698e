#include "store/calibration_json.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/optics_json.hpp"
#include "octurn/units.hpp"
#include "settings/pose_json.hpp"
#include "store/laser_planes.hpp"
#include "store/parameters_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int max_stop = std::numeric_limits<int>::max();

json to_json(const CalibrationFinding& finding) {
  json object{{"code", finding.code}, {"detail", finding.detail}, {"hint", finding.hint}};
  if (finding.stop) {
    object["stop"] = *finding.stop;
  }
  if (finding.angle) {
    object["deg"] = degrees_from_radians(*finding.angle);
  }
  if (!finding.parameters.empty()) {
    object["parameters"] = octurn::to_json(finding.parameters);
  }
  return object;
}

json to_json(const SolvedPose& solved) {
  json object{{"platform_from_sensor", to_rows(solved.platform_from_sensor)},
              {"sigma_mm", mm_from_metres(solved.position_sigma)},
              {"sigma_deg", degrees_from_radians(solved.direction_sigma)},
              {"before_mm", mm_from_metres(solved.before)},
              {"after_mm", mm_from_metres(solved.after)}};
  if (solved.optics) {
    object["optics"] = to_json(*solved.optics);
  }
  return object;
}

CalibrationFinding to_finding(const JsonValue& object) {
  JsonObject keys(object);
  CalibrationFinding finding{.code = keys.at("code").text(),
                             .detail = keys.at("detail").text(),
                             .hint = keys.at("hint").text(),
                             .stop = keys.whole_number("stop", 0, max_stop),
                             .angle = {},
                             .parameters = to_parameters(keys.value("parameters"))};
  if (const auto deg = keys.value("deg")) {
    finding.angle = radians_from_degrees(deg->number());
  }
  return finding;
}

SolvedPose to_solved_pose(const JsonValue& object) {
  JsonObject keys(object);
  const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
  const auto optics = keys.value("optics");
  return {.platform_from_sensor = to_pose(keys.at("platform_from_sensor")),
          .position_sigma = metres("sigma_mm"),
          .direction_sigma = radians_from_degrees(keys.at("sigma_deg").number()),
          .before = metres("before_mm"),
          .after = metres("after_mm"),
          .optics = optics ? std::optional(solved_optics_from(*optics)) : std::nullopt};
}

}  // namespace

json to_json(const std::vector<CalibrationFinding>& findings) {
  json list = json::array();
  for (const CalibrationFinding& finding : findings) {
    list.push_back(to_json(finding));
  }
  return list;
}

std::vector<CalibrationFinding> to_findings(const JsonValue& list) {
  std::vector<CalibrationFinding> findings;
  for (const JsonValue& finding : list.elements()) {
    findings.push_back(to_finding(finding));
  }
  return findings;
}

json to_json(const CalibrationReport& report, const std::vector<double>& angles) {
  json stops = json::array();
  for (std::size_t stop = 0; stop < report.stop_offsets.size(); ++stop) {
    stops.push_back({{"angle_deg", degrees_from_radians(angles[stop])},
                     {"off_deg", degrees_from_radians(report.stop_offsets[stop])}});
  }
  return {{"accepted", report.accepted},
          {"reason", report.reason},
          {"platform_from_sensor",
           report.accepted ? to_rows(report.platform_from_sensor) : json(nullptr)},
          {"shift_mm", mm_from_metres(report.shift)},
          {"tilt_deg", degrees_from_radians(report.tilt)},
          {"sigma_mm", mm_from_metres(report.position_sigma)},
          {"sigma_deg", degrees_from_radians(report.direction_sigma)},
          {"before_mm", mm_from_metres(report.before)},
          {"after_mm", mm_from_metres(report.after)},
          {"optics", report.optics ? to_json(*report.optics) : json(nullptr)},
          {"stops", std::move(stops)},
          {"findings", to_json(report.findings)}};
}

json to_json(const CalibrationReport& report, const std::vector<double>& angles,
             const std::vector<Laser>& lasers) {
  json object = to_json(report, angles);
  object["lasers"] = planes_to_json(lasers);
  return object;
}

json to_json(const ScanCalibration& calibration) {
  json object{{"accepted", calibration.accepted},
              {"confirms_told", calibration.confirms_told},
              {"reason", calibration.reason},
              {"solved", calibration.solved ? to_json(*calibration.solved) : json(nullptr)},
              {"findings", to_json(calibration.findings)},
              {"rebuilt", calibration.rebuilt}};
  if (calibration.optics) {
    object["optics"] = to_json(*calibration.optics);
  }
  return object;
}

ScanCalibration to_scan_calibration(const JsonValue& object) {
  JsonObject keys(object);
  ScanCalibration calibration{.accepted = keys.at("accepted").flag(),
                              .confirms_told = keys.at("confirms_told").flag(),
                              .reason = keys.at("reason").text(),
                              .findings = to_findings(keys.at("findings")),
                              .rebuilt = keys.at("rebuilt").whole_number(0, max_stop)};
  if (const JsonValue solved = keys.at("solved"); !solved.json().is_null()) {
    calibration.solved = to_solved_pose(solved);
  }
  if (const auto optics = keys.value("optics")) {
    calibration.optics = solved_optics_from(*optics);
  }
  return calibration;
}

}  // namespace octurn
