#include "io/sensor_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/pose_json.hpp"
#include "io/radial_distortion.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/intrinsics_json.hpp"
#include "octurn/optics_json.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_image_bytes = 256U
                                        << 20U;  // twice an uncompressed image of max_image_side

bool is_control(char character) { return static_cast<unsigned char>(character) < ' '; }

/// Optics of earlier scans have no sigmas: they are read as 0.
SolvedOptics known_optics_from(const JsonValue& object) {
  if (JsonObject(object).value("sigma")) {
    return solved_optics_from(object);
  }
  return {.value = optics_from(object),
          .sigma = {.fx = 0, .fy = 0, .cx = 0, .cy = 0, .depth_scale = 0}};
}

}  // namespace

SensorJson sensor_from(const JsonValue& object) {
  JsonObject keys(object);
  const auto kind = keys.value("kind");
  if (kind && kind->text() != "laser-line") {
    kind->refuse("\"laser-line\", or left out for a sensor that measures depth");
  }
  SensorJson sensor{.name = keys.at("name").text(), .serial = {}, .intrinsics = lens_from(keys)};
  sensor.intrinsics.width = keys.at("width").whole_number(2, max_image_side);
  sensor.intrinsics.height = keys.at("height").whole_number(2, max_image_side);
  if (kind) {
    sensor.laser = laser_camera_from(keys, sensor.intrinsics);
  } else {
    sensor.intrinsics.depth_unit = depth_unit_from(keys);
    if (const auto optics = keys.value("optics")) {
      sensor.optics = known_optics_from(*optics);
    }
    sensor.scale_sigma = keys.number("scale_sigma", 0, 1).value_or(unknown_scale_sigma);
  }
  sensor.serial = keys.text("serial").value_or("");
  sensor.on_for = keys.number("on_for_s", 0, max_on_for);
  return sensor;
}

nlohmann::json to_json(const SensorJson& sensor) {
  const Intrinsics& intrinsics = sensor.intrinsics;
  nlohmann::json object{{"name", sensor.name},         {"width", intrinsics.width},
                        {"height", intrinsics.height}, {"fx", intrinsics.fx},
                        {"fy", intrinsics.fy},         {"cx", intrinsics.cx},
                        {"cy", intrinsics.cy}};
  if (sensor.laser) {
    add_laser_camera(object, *sensor.laser);
  } else {
    object["depth_unit_m"] = intrinsics.depth_unit;
    if (sensor.optics) {
      const bool has_sigmas = sensor.optics->sigma.fx > 0;
      object["optics"] = has_sigmas ? to_json(*sensor.optics) : to_json(sensor.optics->value);
    }
    if (sensor.scale_sigma != unknown_scale_sigma) {
      object["scale_sigma"] = sensor.scale_sigma;
    }
  }
  if (!sensor.serial.empty()) {
    object["serial"] = sensor.serial;
  }
  if (sensor.on_for) {
    object["on_for_s"] = *sensor.on_for;
  }
  return object;
}

std::string file_inside(const JsonValue& value, const std::string& must) {
  std::string text = value.text();
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == ".." || !path.has_filename() ||
      path == "." || std::ranges::any_of(text, is_control)) {
    value.refuse(must);
  }
  return text;
}

std::string read_bytes(const std::filesystem::path& file, ErrorCode missing, std::string_view hint,
                       ErrorCode malformed) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error(missing, file.string() + ": " + (error ? error.message() : "not a regular file"),
                std::string(hint));
  }
  if (std::filesystem::file_size(file, error) > max_image_bytes) {
    throw Error(malformed, file.string() + ": too large for a file of a scan");
  }
  return read_regular_file(file, max_image_bytes).value_or("");
}

std::string read_scan_file(const std::filesystem::path& file) {
  return read_bytes(file, ErrorCode::scan_missing, "Name a folder that holds a whole scan.",
                    ErrorCode::scan_malformed);
}

namespace {

using nlohmann::json;

constexpr std::string_view dark = "dark";     // the picture without laser light
constexpr std::size_t max_lasers = 8;         // more than any rig has
constexpr double normal_tolerance = 1e-4;     // for rounded decimals in a file
constexpr double max_source_distance = 0.05;  // metres of a laser from its plane
constexpr double max_laser_place = 100;       // metres

std::array<double, 4> plane_from(const JsonValue& value) {
  std::array<double, 4> plane{};
  std::ranges::transform(value.elements(4), plane.begin(), [](const JsonValue& element) {
    return element.number(-max_laser_place, max_laser_place);
  });
  return plane;
}

Laser laser_from(const JsonValue& value) {
  JsonObject keys(value);
  Laser laser{.name = keys.at("name").text()};
  if (laser.name.empty() || laser.name == dark) {
    keys.at("name").refuse("a name of its own, other than \"dark\"");
  }
  const JsonValue plane = keys.at("plane_m");
  const auto [x, y, z, distance] = plane_from(plane);
  const Eigen::Vector3d normal(x, y, z);
  const double length = normal.norm();
  if (std::abs(length - 1) > normal_tolerance) {
    plane.refuse("a plane [nx, ny, nz, d] with a normal of length 1");
  }
  laser.normal = normal / length;
  laser.distance = distance / length;
  if (const auto source = keys.value("source_m")) {
    laser.source = point_from(*source);
    if (!(std::abs(laser.normal.dot(*laser.source) - laser.distance) < max_source_distance)) {
      source->refuse("a place within 5 cm of the laser's plane, in the camera's frame");
    }
  }
  return laser;
}

/// The distance of the picture's farthest corner from the principal point, normalised coordinates.
double corner_radius(const Intrinsics& lens) {
  const double x = std::max(std::abs(lens.cx), std::abs(lens.width - 1 - lens.cx)) / lens.fx;
  const double y = std::max(std::abs(lens.cy), std::abs(lens.height - 1 - lens.cy)) / lens.fy;
  return std::hypot(x, y);
}

}  // namespace

std::vector<Laser> lasers_from(const JsonValue& lasers) {
  std::vector<Laser> all;
  for (const JsonValue& value : lasers.elements()) {
    Laser laser = laser_from(value);
    if (std::ranges::count(all, laser.name, &Laser::name) > 0) {
      value.refuse("a laser with a name of its own");
    }
    all.push_back(std::move(laser));
  }
  if (all.empty() || all.size() > max_lasers) {
    lasers.refuse("an array of 1 to 8 lasers");
  }
  return all;
}

json to_json(const std::vector<Laser>& lasers) {
  json all = json::array();
  for (const Laser& laser : lasers) {
    const Eigen::Vector3d& n = laser.normal;
    json value{{"name", laser.name}, {"plane_m", {n.x(), n.y(), n.z(), laser.distance}}};
    if (laser.source) {
      value["source_m"] = {laser.source->x(), laser.source->y(), laser.source->z()};
    }
    all.push_back(std::move(value));
  }
  return all;
}

LaserCamera laser_camera_from(JsonObject& sensor, const Intrinsics& intrinsics) {
  const JsonValue k1 = sensor.at("k1");
  const JsonValue k2 = sensor.at("k2");
  LaserCamera camera{.k1 = k1.number(-max_distortion, max_distortion),
                     .k2 = k2.number(-max_distortion, max_distortion),
                     .lasers = lasers_from(sensor.at("lasers"))};
  const RadialDistortion distortion{.k1 = camera.k1, .k2 = camera.k2};
  if (!distortion.is_invertible_to(corner_radius(intrinsics))) {
    k1.refuse("with \"k2\" a distortion that does not fold the picture over");
  }
  return camera;
}

void add_laser_camera(json& sensor, const LaserCamera& camera) {
  sensor["kind"] = "laser-line";
  sensor["k1"] = camera.k1;
  sensor["k2"] = camera.k2;
  sensor["lasers"] = to_json(camera.lasers);
}

std::vector<std::string> pictures_from(const JsonValue& files, const LaserCamera& camera) {
  JsonObject keys(files);
  const auto file = [&](std::string_view name) {
    return file_inside(keys.at(name), "a file in the scan's folder");
  };
  std::vector<std::string> pictures{file(dark)};
  for (const Laser& laser : camera.lasers) {
    pictures.push_back(file(laser.name));
  }
  return pictures;
}

json pictures_json(const std::vector<std::string>& pictures, const LaserCamera& camera) {
  json files{{dark, pictures.front()}};
  for (std::size_t i = 0; i < camera.lasers.size(); ++i) {
    files[camera.lasers[i].name] = pictures[i + 1];
  }
  return files;
}

Intrinsics lens_from(JsonObject& keys) {
  return {.fx = keys.at("fx").number(min_focal, max_focal),
          .fy = keys.at("fy").number(min_focal, max_focal),
          .cx = keys.at("cx").number(-max_image_side, max_image_side),
          .cy = keys.at("cy").number(-max_image_side, max_image_side)};
}

double depth_unit_from(JsonObject& keys) {
  return keys.at("depth_unit_m").number(min_depth_unit, max_depth_unit);
}

namespace {

constexpr double min_depth_scale = 0.5;
constexpr double max_depth_scale = 2;
constexpr double max_depth_offset = 1;  // 1/m: a Kinect's nearest reading is 2 1/m

SensorOptics sigma_from(const JsonValue& object) {
  JsonObject keys(object);
  const auto sigma = [&](std::string_view key) {
    return keys.at(key).number(0, std::numeric_limits<double>::max());
  };
  return {.fx = sigma("fx"),
          .fy = sigma("fy"),
          .cx = sigma("cx"),
          .cy = sigma("cy"),
          .k1 = sigma("k1"),
          .k2 = sigma("k2"),
          .depth_scale = sigma("depth_scale"),
          .depth_offset_per_m = sigma("depth_offset_per_m")};
}

}  // namespace

json to_json(const SensorOptics& optics) {
  return {{"fx", optics.fx},
          {"fy", optics.fy},
          {"cx", optics.cx},
          {"cy", optics.cy},
          {"k1", optics.k1},
          {"k2", optics.k2},
          {"depth_scale", optics.depth_scale},
          {"depth_offset_per_m", optics.depth_offset_per_m}};
}

SensorOptics optics_from(const JsonValue& object) {
  JsonObject keys(object);
  const Intrinsics lens = lens_from(keys);
  return {.fx = lens.fx,
          .fy = lens.fy,
          .cx = lens.cx,
          .cy = lens.cy,
          .k1 = keys.at("k1").number(-max_distortion, max_distortion),
          .k2 = keys.at("k2").number(-max_distortion, max_distortion),
          .depth_scale = keys.at("depth_scale").number(min_depth_scale, max_depth_scale),
          .depth_offset_per_m =
              keys.at("depth_offset_per_m").number(-max_depth_offset, max_depth_offset)};
}

json to_json(const SolvedOptics& optics) {
  json object = to_json(optics.value);
  object["sigma"] = to_json(optics.sigma);
  return object;
}

SolvedOptics solved_optics_from(const JsonValue& object) {
  JsonObject keys(object);
  return {.value = optics_from(object), .sigma = sigma_from(keys.at("sigma"))};
}

const SensorTraits& sensor_traits(std::string_view name) {
  static constexpr SensorTraits kinect;
  // Calculated from its data sheet, not measured: 18 mm between its cameras, a focal length of 447
  // pixels, and noise of 0.08 pixels of disparity.
  static constexpr SensorTraits d405{.nearest = 0.07,
                                     .best_near = 0.1,
                                     .best_far = 0.3,
                                     .farthest = 0.5,
                                     .disagreement_at_1_m = 0.018,
                                     .noise_distance = 0.25,
                                     .truncation = 0.0025};
  return name.find("RealSense D405") != std::string_view::npos ? d405 : kinect;
}

const SensorTraits& sensor_traits(const Scan& scan) {
  return scan.laser ? laser_traits : sensor_traits(scan.sensor_name);
}

}  // namespace octurn
