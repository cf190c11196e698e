#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "rig/nominal_laser_rig.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

// A limit of lasers, in settings and in files.
inline constexpr double max_laser_coordinate = 10;  ///< metres, of a plane and of a source

/// The kind of sensor of a rig.
enum class SensorKind {
  depth,       ///< a depth sensor
  laser_line,  ///< a camera with line lasers
};

/// The kind's name in settings: "depth", "laser-line".
std::string_view to_string(SensorKind kind);

/// A line laser, and the line of the GPIO header that switches it.
struct LaserLine {
  std::string gpio_line = {};  ///< by the kernel's name; empty: there is no such laser
  Laser laser = {};
};

/// Settings of a camera with line lasers. The defaults are those of the rig's drawing.
struct LaserSettings {
  Intrinsics lens = {
      .width = 820, .height = 616, .fx = 682.4, .fy = 682.4, .cx = 409.5, .cy = 307.5};
  double k1 = 0;  ///< radial distortion, as in `LaserCamera`
  double k2 = 0;
  std::chrono::milliseconds exposure{10};  ///< of each picture
  double gain = 1;
  Eigen::Isometry3d platform_from_sensor = nominal_platform_from_camera();  ///< metres
  LaserLine left = {.gpio_line = "GPIO23", .laser = nominal_laser("left", -std::numbers::pi / 6)};
  LaserLine right = {.gpio_line = "GPIO24", .laser = nominal_laser("right", std::numbers::pi / 6)};
};

/// Returns the lasers with a GPIO line. The two functions below keep their order.
std::vector<LaserLine> lines_of(const LaserSettings& settings);
LaserCamera laser_camera(const LaserSettings& settings);
std::vector<std::string> to_gpio_names(const LaserSettings& settings);

struct Field;

/// Returns every setting of the rig, with its key, unit and range.
std::vector<Field> fields(LaserSettings& settings);
/// Returns the settings of one laser.
std::vector<Field> fields(LaserLine& line);

/// Refuses a rig without a laser, and GPIO lines that both lasers share or that are high while a
/// Raspberry Pi boots.
/// @param keys  the JSON of the settings, for messages
void check_laser_settings(JsonObject& keys, const LaserSettings& settings);

/// The default settling time of a turntable with lasers. The dark picture, in which nothing is
/// measured, is exposed first. At 15 pictures a second the first line is therefore exposed at least
/// 217 ms after the move, or 283 ms if the camera reads a picture out until the next one begins.
inline constexpr std::chrono::milliseconds laser_settle_time{150};

/// Sets the defaults of a laser-line scan: lines 1.8 degrees apart, one picture each, and the space
/// that the drawing's camera and lasers cover. It begins 2 mm above the platform, as the noise is
/// lower than a depth sensor's.
void use_laser_capture_defaults(ScanSettings& settings);

}  // namespace octurn
