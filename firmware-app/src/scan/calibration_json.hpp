#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/json_object.hpp"
#include "scan/job.hpp"

namespace octurn {

/// The JSON of `octurn calibrate --json`: millimetres and degrees.
/// @param angles  of the stops as told, radians
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles);

/// The same of a scan by laser line.
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles,
                       const std::vector<Laser>& lasers);

/// A scan's calibration as the API and `job.json` have it.
nlohmann::json to_json(const ScanCalibration& calibration);

/// Findings, as in the API and the files.
nlohmann::json to_json(const std::vector<CalibrationFinding>& findings);

/// Reads findings from that JSON. @throws Error  with the value's code
std::vector<CalibrationFinding> to_findings(const JsonValue& list);

/// The calibration of a `job.json`. @throws Error  of the value's code
ScanCalibration to_scan_calibration(const JsonValue& object);

}  // namespace octurn
