#pragma once

#include <filesystem>
#include <string_view>

namespace octurn {

/// The map of a sensor's own error among the files of this machine: `sensor-maps/SERIAL.png`. What
/// is no letter, digit, dot, dash or underscore in the serial number becomes an underscore.
/// @param data  the data folder
std::filesystem::path sensor_map_of(const std::filesystem::path& data, std::string_view serial);

/// Copies that map into a scan's folder, as its `sensor-map.png`: the scan then keeps it, whatever
/// becomes of the machine's. Does nothing where there is none, or the sensor tells no serial
/// number.
/// @throws Error "disk-full", "write-failed", "read-failed"
void keep_sensor_map(const std::filesystem::path& data, std::string_view serial,
                     const std::filesystem::path& folder);

}  // namespace octurn
