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
  std::optional<LaserCamera> laser = {};  ///< none: the sensor measures depth
};

SensorJson sensor_from(const JsonValue& object);
nlohmann::json to_json(const SensorJson& sensor);

/// A file's name inside a folder. @throws Error  if it is absolute, leads out, or is no name
/// @param must  completes "... must be"
std::string file_inside(const JsonValue& value, const std::string& must);

/// The content of a file of a scan or a wall.
/// @param missing  code of the error if there is none, and what is to be done about it
/// @param malformed  code of the error if it is too large
std::string read_bytes(const std::filesystem::path& file, ErrorCode missing, std::string_view hint,
                       ErrorCode malformed);

/// The content of a file of a scan folder. @throws Error "scan-missing", "scan-malformed"
std::string read_scan_file(const std::filesystem::path& file);

}  // namespace octurn
