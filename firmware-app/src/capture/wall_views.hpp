#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "capture/rig.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {

/// Frames of one wall view: more than 25 do not lower the noise that remains in a map.
inline constexpr int default_wall_frames = 25;
inline constexpr int max_wall_frames = 200;

/// Reads frames of a wall. A simulated sensor renders one meanwhile; any other has to be pointed at
/// a wall.
///
/// @param wall      metres: distance of a simulated sensor's wall
/// @param on_for    seconds that the sensor had been on, if known
/// @param on_frame  called with each frame, and the number of frames so far
/// @return nullopt if stopped first
/// @throws Error "sensor-..."
std::optional<WallView> look_at_wall(
    DepthSensor& sensor, int frames, double wall, std::optional<double> on_for,
    const std::stop_token& stop,
    const std::function<void(const DepthFrame& frame, int frames)>& on_frame);

// The wall views that a sensor's map is fitted to are stored in the data folder, one for each
// distance: `sensor-maps/SERIAL/650` is a wall folder whose one frame is the mean of the frames of
// a wall at 650 mm. Its depth unit is 0.05 mm, whatever the sensor's is, so that the mean is not
// rounded to the sensor's.

/// Returns the distance of a simulated sensor's next wall, metres: the near wall first, then the
/// far one.
double next_wall(const std::filesystem::path& data, std::string_view serial);

/// Fits a sensor's map to its stored wall views again, since its optics have changed: what these
/// take out, the map must not correct again. Does nothing without stored views; keeps the old map,
/// and warns, if the new one is refused or a view cannot be read.
void remake_sensor_map(const std::filesystem::path& data, std::string_view serial);

/// Fits a sensor's map, with its optics in force, to a new wall view and to the stored ones at
/// other distances, and stores map and view if the map is accepted. Then the new view replaces
/// those within 0.1 m of its distance, or with other intrinsics.
///
/// @param data    the data folder
/// @param serial  of the sensor; not empty
/// @return the report, without the pixels of its map
/// @throws Error "recording-malformed", "snapshot-malformed"  if a stored view cannot be read
/// @throws Error "disk-full", "write-failed"
SensorMapReport add_wall(const std::filesystem::path& data, std::string_view serial,
                         const WallView& view);

}  // namespace octurn
