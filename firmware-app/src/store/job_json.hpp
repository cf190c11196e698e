#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "octurn/quality.hpp"
#include "octurn/scan_folder.hpp"
#include "store/job.hpp"

namespace octurn {

/// The limit of numbers that have none.
inline constexpr double unlimited = std::numeric_limits<double>::max();

/// Rounds to three decimals, the precision of seconds, millimetres and fractions in JSON.
double to_thousandths(double value);

/// Reads the number of an optional key, from 0 to `max`; 0 if it is missing or null.
/// @throws Error  if it is not a number, or out of range
double number_or_zero(JsonObject& keys, std::string_view key, double max);

/// JSON of a model, for the API, `job.json` and `build.json`.
nlohmann::json to_json(const Model& model);

/// Parses that JSON, also of earlier versions. @throws Error  with the code of `object`
Model to_model(const JsonValue& object);

/// JSON of a calibration, as `octurn calibrate --json` prints it: millimetres and degrees.
/// @param angles  commanded angles of the stops, radians
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles);

/// The same for a laser-line scan, with the planes of its lasers.
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles,
                       const std::vector<Laser>& lasers);

/// JSON of a scan's calibration, for the API and `job.json`.
nlohmann::json to_json(const ScanCalibration& calibration);

/// JSON of findings, for the API and the files.
nlohmann::json to_json(const std::vector<CalibrationFinding>& findings);

/// Parses that JSON. @throws Error  with the code of `list`
std::vector<CalibrationFinding> to_findings(const JsonValue& list);

/// Parses the calibration of a `job.json`. @throws Error  with the code of `object`
ScanCalibration to_scan_calibration(const JsonValue& object);

/// JSON of the lasers' names and planes, for files, `--json` and the API.
nlohmann::json planes_to_json(const std::vector<Laser>& lasers);

/// Parses that JSON to lasers without `source`. @throws Error  with the code of `list`
std::vector<Laser> to_planes(const JsonValue& list);

/// JSON of a failure, for the API and `job.json`.
nlohmann::json to_json(const Failure& failure);

/// Parses that JSON. @throws Error  with the code of `object`
Failure to_failure(const JsonValue& object);

/// JSON of a message's values, for the API and `job.json`: an object of numbers and strings.
nlohmann::json to_json(const Parameters& parameters);

/// Parses that JSON; nullopt gives no values. @throws Error  with the code of `object`
Parameters to_parameters(const std::optional<JsonValue>& object);

/// JSON of a verdict, for the API and `job.json`.
nlohmann::json to_json(const Quality& quality);

/// Parses that JSON. @throws Error  with the code of `object`
Quality to_quality(const JsonValue& object);

/// JSON of a registration's candidate, for the API and `job.json`: its pose in metres, its residual
/// in millimetres.
nlohmann::json to_json(const RegistrationCandidate& candidate);

/// JSON of a registration, for the API and `job.json`: poses in metres, residual and sigmas in
/// millimetres and degrees.
nlohmann::json to_json(const PoseRegistration& registration);

/// JSON of the link from another pose's scan to the first scan, for the API and `job.json`.
nlohmann::json to_json(const PoseOf& pose_of);

/// Parses that JSON. @throws Error  with the code of `object`
PoseOf to_pose_of(const JsonValue& object);

}  // namespace octurn
