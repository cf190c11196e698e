#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace octurn {

/// What a simulated sensor shows and how it misbehaves. It travels as the URI by which OpenNI2
/// opens the sensor: `octurn-simulator://[MESH][?key=value&...]`, with the keys `seed`, `noise`,
/// `speed`, `silent-after` and `lost-after`. In MESH, `%` and `?` are written `%25` and `%3F`.
struct Simulation {
  std::string mesh_file = {};  // STL or OBJ in millimetres, Z up; empty: the simulator's own object
  std::uint32_t seed = 1;      // of the noise: same seed, same frames
  double noise = 1.0;          // times a real Kinect's; 0 leaves the steps and the shadow
  double speed = 1.0;          // times 30 frames a second, as far as the processor goes
  std::optional<int> silent_after = {};  // frames, then none, as if the sensor had hung
  std::optional<int> lost_after = {};    // frames, then the device is gone, as if unplugged
};

/// How the URI of every simulated sensor begins.
inline constexpr std::string_view simulator_scheme = "octurn-simulator://";

/// The property of a simulated device that turns its platform: a double, radians, counter-clockwise
/// seen from above. No other device of OpenNI2 has a property of this number.
inline constexpr int platform_angle_property = 0x4F430001;

/// @throws Error "bad-simulation" if it is longer than the 255 characters that OpenNI2 takes
std::string simulation_uri(const Simulation& simulation);

/// @throws Error "bad-simulation" if a key is unknown or its value out of range
Simulation parse_simulation(std::string_view uri);

}  // namespace octurn
