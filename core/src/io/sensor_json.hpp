#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The key "sensor" of scan.json and wall.json.
struct SensorJson {
  std::string name = {};
  std::string serial = {};  ///< empty if there is none
  Intrinsics intrinsics = {};
  std::optional<LaserCamera> laser = {};    ///< none: the sensor measures depth
  std::optional<SolvedOptics> optics = {};  ///< of a depth sensor, if they were known
  double scale_sigma = unknown_scale_sigma;
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

}  // namespace octurn
