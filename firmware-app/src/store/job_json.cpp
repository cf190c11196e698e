#include "store/job_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>

#include "octurn/optics_json.hpp"
#include "octurn/units.hpp"
#include "settings/laser_settings.hpp"
#include "settings/pose_field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr double max_whole = 1e15;  // a double holds every whole number up to there

std::uint64_t count(const JsonValue& value) {
  return static_cast<std::uint64_t>(value.number(0, max_whole));
}

std::optional<Quality> quality_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_quality(*object));
}

constexpr double stored_normal_tolerance = 1e-4;  // rounding of decimals in a file

}  // namespace

json to_json(const Model& model) {
  const ModelReport& report = model.report;
  const bool counted = report.parts > 0;
  json size_mm = json::array();
  for (const double side : report.size) {
    size_mm.push_back(to_thousandths(mm_from_metres(side)));
  }
  return {{"parts", counted ? json(report.parts) : json()},
          {"dropped_parts", counted ? json(report.dropped.count) : json()},
          {"dropped_volume_cm3",
           counted ? json(to_thousandths(cm3_from_m3(report.dropped.volume))) : json()},
          {"filled_share", counted ? json(to_thousandths(report.filled_share)) : json()},
          {"bytes", report.bytes},
          {"triangles", report.triangles},
          {"leaves", report.leaves},
          {"watertight", report.watertight},
          {"volume_cm3", to_thousandths(cm3_from_m3(report.volume))},
          {"size_mm", std::move(size_mm)},
          {"seconds", to_thousandths(model.build_time.count())},
          {"quality", model.quality ? to_json(*model.quality) : json()}};
}

Model to_model(const JsonValue& object) {
  JsonObject keys(object);
  Model model{
      .report = {.leaves = count(keys.at("leaves")),
                 .triangles = count(keys.at("triangles")),
                 .bytes = count(keys.at("bytes")),
                 .parts = static_cast<std::uint64_t>(number_or_zero(keys, "parts", max_whole)),
                 .filled_share = number_or_zero(keys, "filled_share", 1),
                 .watertight = keys.flag("watertight").value_or(false),
                 .volume = m3_from_cm3(keys.at("volume_cm3").number(0, unlimited)),
                 .dropped = {.count = static_cast<std::uint64_t>(
                                 number_or_zero(keys, "dropped_parts", max_whole)),
                             .volume = m3_from_cm3(
                                 number_or_zero(keys, "dropped_volume_cm3", unlimited))}},
      .build_time = Seconds(keys.at("seconds").number(0, unlimited)),
      .quality = quality_from(keys.value("quality"))};
  const std::vector<JsonValue> size = keys.at("size_mm").elements(3);
  for (int axis = 0; axis < 3; ++axis) {
    model.report.size[axis] = metres_from_mm(size[static_cast<std::size_t>(axis)].number());
  }
  return model;
}

namespace {

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

nlohmann::json planes_to_json(const std::vector<Laser>& lasers) {
  nlohmann::json list = nlohmann::json::array();
  for (const Laser& laser : lasers) {
    const Eigen::Vector3d& n = laser.normal;
    list.push_back({{"name", laser.name}, {"plane_m", {n.x(), n.y(), n.z(), laser.distance}}});
  }
  return list;
}

std::vector<Laser> to_planes(const JsonValue& list) {
  std::vector<Laser> lasers;
  for (const JsonValue& value : list.elements()) {
    JsonObject keys(value);
    const JsonValue plane = keys.at("plane_m");
    const std::vector<JsonValue> numbers = plane.elements(4);
    const auto number = [&](std::size_t i) {
      return numbers[i].number(-max_laser_coordinate, max_laser_coordinate);
    };
    Laser laser{.name = keys.at("name").text(), .normal = {number(0), number(1), number(2)}};
    laser.distance = number(3);
    if (std::abs(laser.normal.norm() - 1) > stored_normal_tolerance) {
      plane.refuse("a plane nx, ny, nz, d with a normal of length 1");
    }
    lasers.push_back(std::move(laser));
  }
  return lasers;
}

nlohmann::json to_json(const Failure& failure) {
  nlohmann::json object{
      {"code", to_string(failure.code)}, {"detail", failure.detail}, {"hint", failure.hint}};
  if (!failure.parameters.empty()) {
    object["parameters"] = to_json(failure.parameters);
  }
  return object;
}

Failure to_failure(const JsonValue& object) {
  JsonObject keys(object);
  return {.code = to_error_code(keys.at("code").text()).value_or(ErrorCode::unknown),
          .detail = keys.at("detail").text(),
          .hint = keys.at("hint").text(),
          .parameters = to_parameters(keys.value("parameters"))};
}

nlohmann::json to_json(const Parameters& parameters) {
  nlohmann::json object = nlohmann::json::object();
  for (const auto& [name, value] : parameters) {
    std::visit([&object, &name = name](const auto& plain) { object[name] = plain; }, value);
  }
  return object;
}

Parameters to_parameters(const std::optional<JsonValue>& object) {
  Parameters parameters;
  if (!object) {
    return parameters;
  }
  if (!object->json().is_object()) {
    object->refuse("an object");
  }
  for (const auto& [name, json] : object->json().items()) {
    const JsonValue value(json, object->name() + "." + name, object->code());
    if (json.is_string()) {
      parameters.emplace(name, value.text());
    } else {
      parameters.emplace(name, value.number());
    }
  }
  return parameters;
}

namespace {

constexpr std::array verdicts{Verdict::good, Verdict::look, Verdict::bad};

/// JSON of places, rounded to whole millimetres.
json to_places_mm(const std::vector<Eigen::Vector3d>& places) {
  json rows = json::array();
  for (const Eigen::Vector3d& place : places) {
    rows.push_back({std::lround(mm_from_metres(place.x())), std::lround(mm_from_metres(place.y())),
                    std::lround(mm_from_metres(place.z()))});
  }
  return rows;
}

std::vector<Eigen::Vector3d> to_places(const JsonValue& rows) {
  std::vector<Eigen::Vector3d> places;
  for (const JsonValue& row : rows.elements()) {
    const std::vector<JsonValue> place = row.elements(3);
    places.emplace_back(metres_from_mm(place[0].number()), metres_from_mm(place[1].number()),
                        metres_from_mm(place[2].number()));
  }
  return places;
}

Verdict to_verdict(const JsonValue& name) {
  const std::string text = name.text();
  const auto* const found = std::ranges::find(
      verdicts, text, [](Verdict verdict) { return std::string(to_string(verdict)); });
  if (found == verdicts.end()) {
    name.refuse("a verdict that this version knows");
  }
  return *found;
}

}  // namespace

json to_json(const Quality& quality) {
  json reasons = json::array();
  for (const QualityReason& reason : quality.reasons) {
    reasons.push_back({{"code", reason.code}, {"detail", reason.detail}, {"hint", reason.hint}});
    if (!reason.parameters.empty()) {
      reasons.back()["parameters"] = to_json(reason.parameters);
    }
    if (!reason.places.empty()) {
      reasons.back()["places_mm"] = to_places_mm(reason.places);
    }
  }
  json object{{"verdict", to_string(quality.verdict)}, {"reasons", reasons}};
  if (quality.size_error) {
    object["size_error"] = {{"mm", mm_from_metres(quality.size_error->error)},
                            {"of_mm", mm_from_metres(quality.size_error->length)}};
  }
  return object;
}

Quality to_quality(const JsonValue& object) {
  JsonObject keys(object);
  Quality quality{.verdict = to_verdict(keys.at("verdict"))};
  for (const JsonValue& reason : keys.at("reasons").elements()) {
    JsonObject of_reason(reason);
    const auto places = of_reason.value("places_mm");
    quality.reasons.push_back(
        {.code = of_reason.at("code").text(),
         .detail = of_reason.at("detail").text(),
         .hint = of_reason.at("hint").text(),
         .parameters = to_parameters(of_reason.value("parameters")),
         .places = places ? to_places(*places) : std::vector<Eigen::Vector3d>{}});
  }
  if (const auto size = keys.value("size_error")) {
    JsonObject of_size(*size);
    quality.size_error = SizeError{.length = metres_from_mm(of_size.at("of_mm").number()),
                                   .error = metres_from_mm(of_size.at("mm").number())};
  }
  return quality;
}

double to_thousandths(double value) { return std::round(value * 1000) / 1000; }

double number_or_zero(JsonObject& keys, std::string_view key, double max) {
  const auto value = keys.value(key);
  return !value || value->json().is_null() ? 0 : value->number(0, max);
}

namespace {

RegistrationCandidate to_candidate(const JsonValue& object) {
  JsonObject keys(object);
  return {.object_from_platform = to_pose(keys.at("object_from_platform")),
          .overlap = keys.at("overlap").number(0, 1),
          .residual = metres_from_mm(keys.at("residual_mm").number()),
          .contradiction = keys.at("contradiction").number(0, 2)};
}

/// Reads the candidates and the chosen one, which earlier versions did not write.
void read_candidates(JsonObject& keys, PoseRegistration& registration) {
  if (const auto candidates = keys.value("candidates")) {
    for (const JsonValue& candidate : candidates->elements()) {
      registration.candidates.push_back(to_candidate(candidate));
    }
  }
  const auto chosen = keys.value("candidate");
  if (chosen && !chosen->json().is_null()) {
    const auto count = static_cast<int>(registration.candidates.size());
    registration.candidate = static_cast<std::size_t>(chosen->whole_number(0, count - 1));
  }
}

PoseRegistration to_registration(const JsonValue& object) {
  JsonObject keys(object);
  PoseRegistration registration{.accepted = keys.at("accepted").flag(),
                                .reason = keys.at("reason").text()};
  if (registration.accepted) {
    const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
    registration.pose = {.object_from_platform = to_pose(keys.at("object_from_platform")),
                         .position_sigma = metres("sigma_mm"),
                         .direction_sigma = radians_from_degrees(keys.at("sigma_deg").number()),
                         .overlap = keys.at("overlap").number(0, 1),
                         .residual = metres("residual_mm"),
                         .contradiction = keys.at("contradiction").number(0, 2),
                         .symmetric = keys.at("symmetric").flag()};
  }
  read_candidates(keys, registration);
  return registration;
}

}  // namespace

json to_json(const RegistrationCandidate& candidate) {
  return {{"object_from_platform", to_rows(candidate.object_from_platform)},
          {"overlap", candidate.overlap},
          {"residual_mm", mm_from_metres(candidate.residual)},
          {"contradiction", candidate.contradiction}};
}

json to_json(const PoseRegistration& registration) {
  json candidates = json::array();
  for (const RegistrationCandidate& candidate : registration.candidates) {
    candidates.push_back(to_json(candidate));
  }
  json object{{"accepted", registration.accepted},
              {"reason", registration.reason},
              {"candidates", std::move(candidates)},
              {"candidate", registration.candidate ? json(*registration.candidate) : json()}};
  if (registration.accepted) {
    const RegisteredPose& pose = registration.pose;
    object.update({{"object_from_platform", to_rows(pose.object_from_platform)},
                   {"sigma_mm", mm_from_metres(pose.position_sigma)},
                   {"sigma_deg", degrees_from_radians(pose.direction_sigma)},
                   {"overlap", pose.overlap},
                   {"residual_mm", mm_from_metres(pose.residual)},
                   {"contradiction", pose.contradiction},
                   {"symmetric", pose.symmetric}});
  }
  return object;
}

json to_json(const PoseOf& pose_of) {
  json object{{"scan", pose_of.scan},
              {"registration", pose_of.registration ? to_json(*pose_of.registration) : json()}};
  if (pose_of.removed_build) {
    object["removed_build"] = *pose_of.removed_build;
  }
  return object;
}

PoseOf to_pose_of(const JsonValue& object) {
  JsonObject keys(object);
  PoseOf pose_of{
      .scan = keys.at("scan").text(),
      .removed_build = keys.whole_number("removed_build", 0, std::numeric_limits<int>::max())};
  if (const JsonValue registration = keys.at("registration"); !registration.json().is_null()) {
    pose_of.registration = to_registration(registration);
  }
  return pose_of;
}

}  // namespace octurn
