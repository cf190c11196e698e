#include "io/pose_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "io/sensor_json.hpp"
#include "octurn/optics_json.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

// Metres from a frame's origin. As far as the box `everywhere` reaches, so that products of places
// and focal lengths stay finite as float.
constexpr double max_pose_coordinate = 1e6;

double place_from(const JsonValue& value) {
  const double place = value.number();
  if (!(std::abs(place) <= max_pose_coordinate)) {
    value.refuse("a number from -1000000 to 1000000");
  }
  return place;
}

SolvedPose solved_from(const JsonValue& solved) {
  JsonObject keys(solved);
  const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
  const auto lasers = keys.value("lasers");
  const auto optics = keys.value("optics");
  return {.platform_from_sensor = pose_from(keys.at("platform_from_sensor")),
          .position_sigma = metres("sigma_mm"),
          .direction_sigma = radians_from_degrees(keys.at("sigma_deg").number()),
          .before = metres("before_mm"),
          .after = metres("after_mm"),
          .lasers = lasers ? lasers_from(*lasers) : std::vector<Laser>{},
          .optics = optics ? std::optional(solved_optics_from(*optics)) : std::nullopt};
}

ScanPose scan_pose_from(const JsonValue& value, const Scan& scan) {
  JsonObject keys(value);
  ScanPose pose{.object_from_platform = {},
                .platform_from_sensor = scan.platform_from_sensor,
                .solved = scan.solved,
                .clip = scan.clip};
  if (const JsonValue matrix = keys.at("object_from_platform"); !matrix.json().is_null()) {
    pose.object_from_platform = pose_from(matrix);
  }
  if (const auto calibration = keys.value("calibration")) {
    RigPose own = calibration_from(*calibration);
    pose.platform_from_sensor = own.platform_from_sensor;
    pose.solved = own.solved;
  }
  if (const auto clip = keys.value("clip_m")) {
    pose.clip = box_from(*clip);
  }
  return pose;
}

}  // namespace

Eigen::Vector3d point_from(const JsonValue& array) {
  Eigen::Vector3d point;
  int axis = 0;
  for (const JsonValue& value : array.elements(3)) {
    point[axis++] = place_from(value);
  }
  return point;
}

Eigen::Isometry3d pose_from(const JsonValue& matrix) {
  Eigen::Matrix4d pose;
  int row = 0;
  for (const JsonValue& values : matrix.elements(4)) {
    int column = 0;
    for (const JsonValue& value : values.elements(4)) {
      pose(row, column++) = place_from(value);
    }
    ++row;
  }
  if (!is_rigid(pose)) {
    matrix.refuse("a rotation and a translation");
  }
  return Eigen::Isometry3d(pose);
}

json to_json(const Eigen::Isometry3d& pose) {
  json matrix = json::array();
  for (int row = 0; row < 4; ++row) {
    matrix.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return matrix;
}

Box box_from(const JsonValue& value) {
  JsonObject keys(value);
  Box box{.min = point_from(keys.at("min")), .max = point_from(keys.at("max"))};
  if ((box.min.array() >= box.max.array()).any()) {
    value.refuse("a box: \"min\" below \"max\" on each axis");
  }
  return box;
}

json to_json(const Box& box) {
  const auto point = [](const Eigen::Vector3d& p) { return json::array({p.x(), p.y(), p.z()}); };
  return {{"min", point(box.min)}, {"max", point(box.max)}};
}

json to_json(const SolvedPose& solved) {
  json value{{"platform_from_sensor", to_json(solved.platform_from_sensor)},
             {"sigma_mm", mm_from_metres(solved.position_sigma)},
             {"sigma_deg", degrees_from_radians(solved.direction_sigma)},
             {"before_mm", mm_from_metres(solved.before)},
             {"after_mm", mm_from_metres(solved.after)}};
  if (!solved.lasers.empty()) {
    value["lasers"] = to_json(solved.lasers);
  }
  if (solved.optics) {
    value["optics"] = to_json(*solved.optics);
  }
  return value;
}

RigPose calibration_from(const JsonValue& calibration) {
  JsonObject keys(calibration);
  RigPose rig{.platform_from_sensor = pose_from(keys.at("platform_from_sensor")), .solved = {}};
  if (const auto solved = keys.value("solved")) {
    rig.solved = solved_from(*solved);
  }
  return rig;
}

json to_json(const RigPose& calibration) {
  json value{{"platform_from_sensor", to_json(calibration.platform_from_sensor)}};
  if (calibration.solved) {
    value["solved"] = to_json(*calibration.solved);
  }
  return value;
}

std::vector<ScanPose> poses_from(const JsonValue& poses, const Scan& scan) {
  if (poses.json().size() > max_poses) {
    poses.refuse("an array of at most " + std::to_string(max_poses));
  }
  std::vector<ScanPose> all;
  for (const JsonValue& pose : poses.elements()) {
    all.push_back(scan_pose_from(pose, scan));
  }
  if (all.empty()) {
    poses.refuse("an array of at least one");
  }
  if (!all.front().object_from_platform) {
    all.front().object_from_platform = Eigen::Isometry3d::Identity();
  }
  return all;
}

json to_json(const std::vector<ScanPose>& poses) {
  json values = json::array();
  for (const ScanPose& pose : poses) {
    values.push_back(
        {{"object_from_platform",
          pose.object_from_platform ? to_json(*pose.object_from_platform) : json(nullptr)},
         {"calibration", to_json(RigPose{.platform_from_sensor = pose.platform_from_sensor,
                                         .solved = pose.solved})},
         {"clip_m", to_json(pose.clip)}});
  }
  return values;
}

}  // namespace octurn
