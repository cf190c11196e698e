#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/json_object.hpp"
#include "store/job.hpp"

namespace octurn {

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

}  // namespace octurn
