#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/json_object.hpp"
#include "scan/job.hpp"

namespace octurn {

/// What `octurn calibrate --json` prints: millimetres and degrees.
/// @param angles  of the stops as told, radians
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles);

/// The same of a scan by laser line.
nlohmann::json to_json(const CalibrationReport& report, const std::vector<double>& angles,
                       const std::vector<Laser>& lasers);

/// A scan's calibration as the API and `job.json` have it.
nlohmann::json to_json(const ScanCalibration& calibration);

/// What was found, as the API and the files have it.
nlohmann::json to_json(const std::vector<CalibrationFinding>& findings);

/// The findings of such JSON. @throws Error  of the value's code
std::vector<CalibrationFinding> to_findings(const JsonValue& list);

/// The calibration of a `job.json`. @throws Error  of the value's code
ScanCalibration to_scan_calibration(const JsonValue& object);

}  // namespace octurn
