#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "octurn/sensor_map.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// Frames of one look at a wall: more than 25 do not lower the noise that a map is left with.
inline constexpr int default_wall_frames = 25;
inline constexpr int max_wall_frames = 200;

/// Reads frames of a wall. A simulated sensor is shown one meanwhile; any other has to be pointed
/// at it.
///
/// @param wall      metres, how far away a simulated sensor is shown it
/// @param on_frame  told each frame, and how many that makes
/// @return nothing if stopped first
/// @throws Error "sensor-..."
std::optional<WallView> look_at_wall(
    DepthSensor& sensor, int frames, double wall, const std::stop_token& stop,
    const std::function<void(const DepthFrame& frame, int frames)>& on_frame);

// The looks that a sensor's map is made of are kept in the data folder, one for each distance:
// `sensor-maps/SERIAL/650` is a wall folder whose one frame is the mean of those of a wall at 650
// mm. Its depth unit is 0.05 mm whatever the sensor's is, so that the mean is not rounded to that.

/// How far away a simulated sensor is shown its next wall, metres: nearer first, then farther.
double next_wall(const std::filesystem::path& data, std::string_view serial);

/// Makes a sensor's map of a new look and of those kept at other distances, and keeps map and look
/// if the map is accepted. A look within 0.1 m of the new one's distance gives way to it.
///
/// @param data    the data folder
/// @param serial  of the sensor; not empty
/// @return what was found; its map, kept, has no pixels here
/// @throws Error "recording-malformed", "snapshot-malformed"  if a kept look cannot be read
/// @throws Error "disk-full", "write-failed"
SensorMapReport add_wall(const std::filesystem::path& data, std::string_view serial,
                         const WallView& view);

}  // namespace octurn
