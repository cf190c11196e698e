#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/sensor_map.hpp"

namespace octurn {

/// Returns the path of the map of a sensor's depth error: `sensor-maps/SERIAL.png`. Characters of
/// the serial number other than letters, digits, dots, dashes and underscores become underscores.
/// @param data  the data folder
std::filesystem::path sensor_map_path(const std::filesystem::path& data, std::string_view serial);

/// Returns the folder of the wall views that this map is fitted to: `sensor-maps/SERIAL`.
std::filesystem::path wall_views_path(const std::filesystem::path& data, std::string_view serial);

/// Removes the map and its wall views. @throws Error "write-failed"
void remove_sensor_map(const std::filesystem::path& data, std::string_view serial);

/// Summary of a map, for display.
struct SensorMapSummary {
  std::string serial = {};
  std::string made = {};  ///< UTC, as in ISO 8601
  double before = 0;      ///< 1/m: rms distance of a wall from a plane
  double after = 0;       ///< 1/m: the same with the map
  /// Seconds that the sensor had been on; see `SensorMap`.
  std::optional<double> on_for = {};
  int columns = 0;                 ///< blocks of 8 x 8 pixels
  int rows = 0;                    ///< of blocks
  std::vector<float> errors = {};  ///< 1/m: mean of each block at the nearest wall, row by row
};

SensorMapSummary summarise(const SensorMap& map);

/// Reads the summary of a sensor's map; nullopt if this machine has none.
/// @throws Error "scan-malformed"  if it is damaged
std::optional<SensorMapSummary> find_map_summary(const std::filesystem::path& data,
                                                 std::string_view serial);

/// Copies that map into a scan's folder, as its `sensor-map.png`, so that later changes of the
/// machine's map do not affect the scan. Does nothing without a map, or without a serial number.
/// @throws Error "disk-full", "write-failed", "read-failed"
void keep_sensor_map(const std::filesystem::path& data, std::string_view serial,
                     const std::filesystem::path& folder);

/// JSON that `octurn calibrate --wall --json` prints. Distances from a plane are in steps of a
/// Kinect's disparity.
nlohmann::json to_json(const SensorMapReport& report);

/// JSON of a map for `GET calibration`, without its picture.
nlohmann::json to_json(const SensorMapSummary& map);

/// JSON of a map's picture: `errors` in steps of a Kinect's disparity.
nlohmann::json to_picture(const SensorMapSummary& map);

}  // namespace octurn
