#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Bound of `on_for_s`, for which a sensor had been on: 30 years, in seconds.
inline constexpr double max_on_for = 1e9;

/// The key "sensor" of scan.json and wall.json.
struct SensorJson {
  std::string name = {};
  std::string serial = {};  ///< empty if there is none
  Intrinsics intrinsics = {};
  std::optional<LaserCamera> laser = {};    ///< none: the sensor measures depth
  std::optional<SolvedOptics> optics = {};  ///< of a depth sensor, if they were known
  double scale_sigma = unknown_scale_sigma;
  std::optional<double> on_for = {};  ///< seconds that it had been on, if known
};

SensorJson sensor_from(const JsonValue& object);
nlohmann::json to_json(const SensorJson& sensor);

/// Reads a file's path relative to a folder.
/// @param must  completes "... must be"
/// @throws Error  if it is absolute, leaves the folder, or is no file name
std::string file_inside(const JsonValue& value, const std::string& must);

/// Reads a file of a scan or a wall.
/// @param missing, hint  code and hint of the error if there is no such file
/// @param malformed      code of the error if it is too large
std::string read_bytes(const std::filesystem::path& file, ErrorCode missing, std::string_view hint,
                       ErrorCode malformed);

/// Reads a file of a scan folder. @throws Error "scan-missing", "scan-malformed"
std::string read_scan_file(const std::filesystem::path& file);

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
