#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// The JSON of a camera with line lasers in `scan.json`. Readers throw an Error that names the
/// wrong value.

/// @param sensor  the key "sensor", whose kind is "laser-line"
LaserCamera laser_camera_from(JsonObject& sensor, const Intrinsics& intrinsics);

/// Adds kind, distortion and lasers to the JSON of a sensor.
void add_laser_camera(nlohmann::json& sensor, const LaserCamera& camera);

/// The array "lasers" of the sensor, or of a solved pose.
std::vector<Laser> lasers_from(const JsonValue& lasers);
nlohmann::json to_json(const std::vector<Laser>& lasers);

/// The object "files" of a snapshot: its pictures, the dark one first, then one for each laser.
std::vector<std::string> pictures_from(const JsonValue& files, const LaserCamera& camera);
nlohmann::json pictures_json(const std::vector<std::string>& pictures, const LaserCamera& camera);

}  // namespace octurn
