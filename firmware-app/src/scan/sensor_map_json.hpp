#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/sensor_map.hpp"
#include "scan/sensor_map_files.hpp"

namespace octurn {

/// What `octurn calibrate --wall --json` prints. Unevenness is in steps of a Kinect's disparity.
nlohmann::json to_json(const SensorMapReport& report);

/// A map as `GET calibration` has it, without its picture.
nlohmann::json to_json(const SensorMapSummary& map);

/// The picture of a map: `errors` in steps of disparity.
nlohmann::json to_picture(const SensorMapSummary& map);

}  // namespace octurn
