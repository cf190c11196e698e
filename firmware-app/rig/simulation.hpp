#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// The interface between the program and Octurn's simulated Kinect: its URIs and its OpenNI2
// properties.

namespace octurn {

/// Settings of a simulated Kinect, encoded in the URI by which OpenNI2 opens it:
/// `octurn-simulator://[MESH][?key=value&...]`, with the keys `seed`, `noise`, `pattern`,
/// `unit`, `misalignment`, `wall`, `speed`, `silent-after` and `lost-after`. In MESH, `%` and `?`
/// are written `%25` and `%3F`.
struct Simulation {
  std::string mesh_file = {};  ///< STL in millimetres, Z up; empty: the simulator's own object
  std::uint32_t seed = 1;      ///< of noise and pattern: same seed, same frames
  double noise = 1.0;          ///< times a real Kinect's; 0 leaves quantisation and shadow
  double pattern = 1.0;        ///< fixed pattern error, times a real Kinect's; 0: none
  std::uint32_t unit = 0;      ///< whose optics it has, as of `optics_of_unit`
  double misalignment = 1.0;   ///< true pose's error, times 5 mm and 1 degree; 0: as configured
  std::optional<double> wall = {};  ///< metres to a wall that it faces instead of the platform
  double speed = 1.0;               ///< times 30 frames a second, as far as the processor keeps up
  std::optional<int> silent_after = {};  ///< frames, then none, as if the sensor had hung
  std::optional<int> lost_after = {};    ///< frames, then the device is gone, as if unplugged
};

/// URI scheme of simulated sensors.
inline constexpr std::string_view simulator_scheme = "octurn-simulator://";

/// Property of type double, written by the program: the platform's angle, radians,
/// counter-clockwise seen from above. No other device of OpenNI2 has a property of this number.
inline constexpr int platform_angle_property = 0x4F430001;

/// Property of type double, written by the program: metres to a wall that the sensor is turned to;
/// 0 turns it back to the platform. A sensor whose URI has a wall ignores it.
inline constexpr int wall_property = 0x4F430003;

/// Property of type double, written by the program: the number of the hold in which somebody shows
/// a printed board to the sensor, a whole number from 1; 0 puts it away.
inline constexpr int board_property = 0x4F430005;
inline constexpr int max_board_hold = 100'000;

/// Property of type double, written by the program: the number of the object's pose, a whole number
/// up to `max_object_pose`; 0 is the initial pose.
inline constexpr int object_pose_property = 0x4F430004;
inline constexpr int max_object_pose = 1000;

/// Property of type double: the time by the simulated sensor's own clock, seconds. It advances by
/// 1/30 s with each frame that was sent or, from `silent_after` on, left out. A machine that is too
/// busy to render in time slows this clock down, so that only a simulated fault is a silence.
inline constexpr int sensor_time_property = 0x4F430002;

/// The real time between two frames, on a machine that keeps up.
std::chrono::steady_clock::duration frame_period(const Simulation& simulation);

/// @throws Error "bad-simulation" if it is longer than the 255 characters that OpenNI2 takes
std::string simulation_uri(const Simulation& simulation);

/// @throws Error "bad-simulation" if a key is unknown or its value out of range
Simulation parse_simulation(std::string_view uri);

}  // namespace octurn
