#include "settings/laser_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "octurn/intrinsics_json.hpp"
#include "settings/field.hpp"
#include "settings/pose_field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr double typed_normal_tolerance = 1e-3;  // rounding of typed decimals
constexpr double max_source_distance = 0.05;     // metres from a laser's source to its plane

/// Lines that a Raspberry Pi pulls up while it boots.
constexpr std::array<std::string_view, 9> pulled_up = {"GPIO0", "GPIO1", "GPIO2", "GPIO3", "GPIO4",
                                                       "GPIO5", "GPIO6", "GPIO7", "GPIO8"};

json numbers_schema(int count) {
  return {
      {"type", "array"},
      {"items",
       {{"type", "number"}, {"minimum", -max_laser_coordinate}, {"maximum", max_laser_coordinate}}},
      {"minItems", count},
      {"maxItems", count}};
}

template <std::size_t count>
std::array<double, count> numbers_from(const JsonValue& given) {
  std::array<double, count> numbers{};
  std::ranges::transform(given.elements(count), numbers.begin(), [](const JsonValue& number) {
    return number.number(-max_laser_coordinate, max_laser_coordinate);
  });
  return numbers;
}

Access plane(Laser& laser) {
  return {.read =
              [&laser](const JsonValue& given) {
                const auto [x, y, z, distance] = numbers_from<4>(given);
                const Eigen::Vector3d normal(x, y, z);
                const double length = normal.norm();
                if (std::abs(length - 1) > typed_normal_tolerance) {
                  given.refuse("a plane nx, ny, nz, d with a normal of length 1");
                }
                laser.normal = normal / length;
                laser.distance = distance / length;
              },
          .write =
              [&laser] {
                const Eigen::Vector3d& n = laser.normal;
                return json{n.x(), n.y(), n.z(), laser.distance};
              },
          .schema = numbers_schema(4)};
}

Access source(Laser& laser) {
  return {.read =
              [&laser](const JsonValue& given) {
                const auto [x, y, z] = numbers_from<3>(given);
                laser.source = Eigen::Vector3d(x, y, z);
              },
          .write =
              [&laser] {
                const Eigen::Vector3d& place = *laser.source;
                return json{place.x(), place.y(), place.z()};
              },
          .schema = numbers_schema(3)};
}

std::vector<Field> lens_fields(LaserSettings& s) {
  return {
      {.key = "width",
       .unit = "pixels",
       .help = "width of the camera's pictures",
       .access = whole(s.lens.width, 2, max_image_side)},
      {.key = "height",
       .unit = "pixels",
       .help = "height of the camera's pictures",
       .access = whole(s.lens.height, 2, max_image_side)},
      {.key = "fx",
       .unit = "pixels",
       .help = "focal length, across",
       .access = number(s.lens.fx, min_focal, max_focal)},
      {.key = "fy",
       .unit = "pixels",
       .help = "focal length, down",
       .access = number(s.lens.fy, min_focal, max_focal)},
      {.key = "cx",
       .unit = "pixels",
       .help = "column of the optical axis; 0 is the middle of the first",
       .access = number(s.lens.cx, -max_image_side, max_image_side)},
      {.key = "cy",
       .unit = "pixels",
       .help = "row of the optical axis",
       .access = number(s.lens.cy, -max_image_side, max_image_side)},
      {.key = "k1",
       .help = "radial distortion of the lens, x (1 + k1 r^2 + k2 r^4)",
       .access = number(s.k1, -max_distortion, max_distortion)},
      {.key = "k2",
       .help = "radial distortion of the lens: the factor of r^4",
       .access = number(s.k2, -max_distortion, max_distortion)},
      {.key = "exposure_ms",
       .unit = "ms",
       .help = "of each picture: longer where a dark object shows no line, shorter where a bright "
               "one is white",
       .access = milliseconds(s.exposure, 1, 1000)},
      {.key = "gain",
       .help = "of the camera's signal, where it can be set; more of it is more noise",
       .access = number(s.gain, 1, 64)},
  };
}

Field line_field(std::string_view key, std::string_view help, LaserLine& line) {
  return {.key = key,
          .help = help,
          .access = object(fields(line), [&line](JsonObject& keys) {
            const double off = line.laser.normal.dot(*line.laser.source) - line.laser.distance;
            if (std::abs(off) > max_source_distance) {
              keys.refuse("source_m", source(line.laser).write(),
                          "within 5 cm of the plane, in the camera's frame");
            }
          })};
}

}  // namespace

std::string_view to_string(SensorKind kind) {
  return kind == SensorKind::depth ? "depth" : "laser-line";
}

std::vector<LaserLine> lines_of(const LaserSettings& settings) {
  std::vector<LaserLine> lines{settings.left, settings.right};
  std::erase_if(lines, [](const LaserLine& line) { return line.gpio_line.empty(); });
  return lines;
}

LaserCamera laser_camera(const LaserSettings& settings) {
  LaserCamera camera{.k1 = settings.k1, .k2 = settings.k2};
  for (const LaserLine& line : lines_of(settings)) {
    camera.lasers.push_back(line.laser);
  }
  return camera;
}

std::vector<std::string> to_gpio_names(const LaserSettings& settings) {
  std::vector<std::string> names;
  for (const LaserLine& line : lines_of(settings)) {
    names.push_back(line.gpio_line);
  }
  return names;
}

std::vector<Field> fields(LaserLine& line) {
  return {
      {.key = "line",
       .unit = "line",
       .help = "to the transistor that switches it: high is on. Of `GPIO9` to `GPIO27`, which are "
               "pulled down while the Pi boots; empty if the rig has no such laser",
       .access = text(line.gpio_line)},
      {.key = "plane_m",
       .unit = "m",
       .help = "nx, ny, nz, d: its light is where n . p = d in the camera's frame; n has length 1",
       .access = plane(line.laser),
       .default_text = "holds the platform's axis, 30 degrees beside the camera"},
      {.key = "source_m",
       .unit = "m",
       .help = "where its light comes from, in the camera's frame",
       .access = source(line.laser),
       .default_text = "0.35 m from the axis, 0.25 m up"},
  };
}

std::vector<Field> fields(LaserSettings& settings) {
  std::vector<Field> all = lens_fields(settings);
  all.push_back({.key = "platform_from_sensor",
                 .unit = "m",
                 .help = "pose of the camera: four rows of four numbers",
                 .access = pose(settings.platform_from_sensor),
                 .default_text = "0.28 m before the axis, 0.18 m up, 25 degrees down"});
  all.push_back(line_field("left", "the laser to the camera's left, below", settings.left));
  all.push_back(line_field("right", "the laser to its right", settings.right));
  return all;
}

void check_laser_settings(JsonObject& keys, const LaserSettings& settings) {
  const std::vector<std::string> lines = to_gpio_names(settings);
  if (lines.empty()) {
    keys.refuse("left", settings.left.gpio_line, "a laser with a line, or \"right\" one");
  }
  for (const std::string& line : lines) {
    if (std::ranges::find(pulled_up, line) != pulled_up.end()) {
      keys.refuse(line == settings.left.gpio_line ? "left" : "right", line,
                  "on a line of GPIO9 to GPIO27: this one is high while the Pi boots");
    }
  }
  if (lines.size() == 2 && lines[0] == lines[1]) {
    keys.refuse("right", lines[1], "on a line of its own");
  }
}

void use_laser_capture_defaults(ScanSettings& settings) {
  use_laser_defaults(settings);
  settings.snapshots = laser_traits.stops;
  settings.filter = DepthFilter::basic;
  settings.clip = {.min = {-0.1, -0.1, 0.002}, .max = {0.1, 0.1, 0.2}};
}

}  // namespace octurn
