#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/sensor_map.hpp"

namespace octurn {

/// The map of a sensor's own error among the files of this machine: `sensor-maps/SERIAL.png`. What
/// is no letter, digit, dot, dash or underscore in the serial number becomes an underscore.
/// @param data  the data folder
std::filesystem::path sensor_map_of(const std::filesystem::path& data, std::string_view serial);

/// The folder of the looks at walls that this map is made of: `sensor-maps/SERIAL`.
std::filesystem::path wall_looks_of(const std::filesystem::path& data, std::string_view serial);

/// Removes the map and its looks. @throws Error "write-failed"
void remove_sensor_map(const std::filesystem::path& data, std::string_view serial);

/// A map as people are shown it.
struct SensorMapSummary {
  std::string serial = {};
  std::string made = {};           ///< UTC, as in ISO 8601
  double before = 0;               ///< 1/m, how far from flat a wall is seen
  double after = 0;                ///< 1/m, with the map
  int columns = 0;                 ///< of blocks of 8 x 8 pixels
  int rows = 0;                    ///< the same
  std::vector<float> errors = {};  ///< 1/m, means of the blocks, row by row, at the nearest wall
};

SensorMapSummary summarise(const SensorMap& map);

/// The map of a sensor; nothing if this machine has none.
/// @throws Error "scan-malformed"  if it is damaged
std::optional<SensorMapSummary> find_map_summary(const std::filesystem::path& data,
                                                 std::string_view serial);

/// Copies that map into a scan's folder, as its `sensor-map.png`: the scan then keeps it, whatever
/// becomes of the machine's. Does nothing where there is none, or the sensor tells no serial
/// number.
/// @throws Error "disk-full", "write-failed", "read-failed"
void keep_sensor_map(const std::filesystem::path& data, std::string_view serial,
                     const std::filesystem::path& folder);

}  // namespace octurn
