#pragma once

#include <nlohmann/json_fwd.hpp>

#include "calibration/sensor_map_files.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {

/// JSON that `octurn calibrate --wall --json` prints. Distances from a plane are in steps of a
/// Kinect's disparity.
nlohmann::json to_json(const SensorMapReport& report);

/// JSON of a map for `GET calibration`, without its picture.
nlohmann::json to_json(const SensorMapSummary& map);

/// JSON of a map's picture: `errors` in steps of a Kinect's disparity.
nlohmann::json to_picture(const SensorMapSummary& map);

}  // namespace octurn
