#include "io/laser_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/pose_json.hpp"
#include "io/radial_distortion.hpp"
#include "io/sensor_json.hpp"
#include "octurn/intrinsics_json.hpp"

namespace octurn {
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

}  // namespace octurn
