#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// What `scan.json` says of a camera with line lasers. Reading throws the Error of a value that is
/// wrong.

/// @param sensor  the key "sensor", whose kind is "laser-line"
LaserCamera laser_camera_from(JsonObject& sensor, const Intrinsics& intrinsics);

/// Adds what a laser camera has to a sensor.
void add_laser_camera(nlohmann::json& sensor, const LaserCamera& camera);

/// Lasers as "lasers" has them, of the sensor or of what was solved.
std::vector<Laser> lasers_from(const JsonValue& lasers);
nlohmann::json to_json(const std::vector<Laser>& lasers);

/// The pictures of a snapshot, "files": the dark one, then one of each laser.
std::vector<std::string> pictures_from(const JsonValue& files, const LaserCamera& camera);
nlohmann::json pictures_json(const std::vector<std::string>& pictures, const LaserCamera& camera);

}  // namespace octurn
