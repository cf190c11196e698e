#include "octurn/scan_folder.hpp"

#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "io/sensor_json.hpp"
#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr ErrorCode malformed = ErrorCode::scan_malformed;

Eigen::Isometry3d pose_from(const JsonValue& matrix) {
  Eigen::Matrix4d pose;
  int row = 0;
  for (const JsonValue& values : matrix.elements(4)) {
    int column = 0;
    for (const JsonValue& value : values.elements(4)) {
      pose(row, column++) = value.number();
    }
    ++row;
  }
  if (!is_rigid(pose)) {
    matrix.refuse("a rotation and a translation");
  }
  return Eigen::Isometry3d(pose);
}

Eigen::Vector3d point_from(const JsonValue& array) {
  Eigen::Vector3d point;
  int axis = 0;
  for (const JsonValue& value : array.elements(3)) {
    point[axis++] = value.number();
  }
  return point;
}

Box clip_from(const JsonValue& clip) {
  JsonObject keys(clip);
  Box box{.min = point_from(keys.at("min")), .max = point_from(keys.at("max"))};
  if ((box.min.array() >= box.max.array()).any()) {
    clip.refuse("a box: \"min\" below \"max\" on each axis");
  }
  return box;
}

Shot shot_from(const JsonValue& shot) {
  JsonObject keys(shot);
  return {.file = file_inside(keys.at("file"), "a file in the scan's folder"),
          .angle = radians_from_degrees(keys.at("angle_deg").number())};
}

SolvedPose solved_from(const JsonValue& solved) {
  JsonObject keys(solved);
  const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
  return {.platform_from_sensor = pose_from(keys.at("platform_from_sensor")),
          .position_sigma = metres("sigma_mm"),
          .direction_sigma = radians_from_degrees(keys.at("sigma_deg").number()),
          .before = metres("before_mm"),
          .after = metres("after_mm")};
}

Scan scan_from(const json& document) {
  JsonObject root(document, malformed, "");
  if (const JsonValue format = root.at("format"); format.text() != "octurn-scan") {
    format.refuse("\"octurn-scan\"");
  }
  if (const JsonValue version = root.at("version"); version.number() != 1) {
    version.refuse("1, which this program reads");
  }
  SensorJson sensor = sensor_from(root.at("sensor"));
  JsonObject calibration(root.at("calibration"));
  Scan scan{.sensor_name = std::move(sensor.name),
            .sensor_serial = std::move(sensor.serial),
            .intrinsics = sensor.intrinsics,
            .platform_from_sensor = pose_from(calibration.at("platform_from_sensor")),
            .clip = clip_from(root.at("clip_m")),
            .shots = {}};
  if (const auto solved = calibration.value("solved")) {
    scan.solved = solved_from(*solved);
  }
  for (const JsonValue& shot : root.at("snapshots").elements()) {
    scan.shots.push_back(shot_from(shot));
  }
  if (scan.shots.empty()) {
    throw Error(ErrorCode::scan_empty, "\"snapshots\" is empty: there is nothing to reconstruct");
  }
  return scan;
}

json to_json(const Eigen::Isometry3d& pose) {
  json matrix = json::array();
  for (int row = 0; row < 4; ++row) {
    matrix.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return matrix;
}

json to_json(const SolvedPose& solved) {
  return {{"platform_from_sensor", to_json(solved.platform_from_sensor)},
          {"sigma_mm", mm_from_metres(solved.position_sigma)},
          {"sigma_deg", degrees_from_radians(solved.direction_sigma)},
          {"before_mm", mm_from_metres(solved.before)},
          {"after_mm", mm_from_metres(solved.after)}};
}

/// A device may call itself by bytes that are no UTF-8; they are replaced.
void write_document(const std::filesystem::path& folder, const json& document) {
  write_file(folder / "scan.json",
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

std::string read_bytes(const std::filesystem::path& file) {
  return read_bytes(file, ErrorCode::scan_missing, "Name a folder that holds a whole scan.",
                    malformed);
}

}  // namespace

Scan parse_scan(std::string_view text) {
  try {
    return scan_from(parse_json(text, malformed, "it"));
  } catch (const Error& error) {
    throw Error(
        error.code(), std::string("scan.json: ") + error.what(),
        error.code() == malformed ? "The folder is not a scan that this version can read." : "");
  }
}

Scan read_scan(const std::filesystem::path& folder) {
  Scan scan = parse_scan(read_bytes(folder / "scan.json"));
  const std::filesystem::path map = folder / sensor_map_file;
  if (std::error_code ignored; std::filesystem::exists(map, ignored)) {
    use_sensor_map(scan, map);
  }
  return scan;
}

void use_sensor_map(Scan& scan, const std::filesystem::path& file) {
  SensorMap map = read_sensor_map(file);
  if (map.width != scan.intrinsics.width || map.height != scan.intrinsics.height) {
    throw Error(ErrorCode::scan_malformed,
                file.string() + ": is for another sensor than the scan's: it has another size",
                "Take the map of the sensor that made the scan.");
  }
  scan.sensor_map = std::make_shared<const SensorMap>(std::move(map));
}

DepthFrame corrected(DepthFrame frame, const Scan& scan) {
  return scan.sensor_map ? corrected(std::move(frame), *scan.sensor_map, scan.intrinsics.depth_unit)
                         : std::move(frame);
}

Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot) {
  const Intrinsics& intrinsics = scan.intrinsics;
  const std::string png = read_bytes(folder / shot.file);
  DepthFrame frame = decode_depth_png(shot.file, std::as_bytes(std::span(png)), intrinsics.width,
                                      intrinsics.height);
  return {.frame = corrected(std::move(frame), scan),
          .intrinsics = intrinsics,
          .object_from_sensor = object_from_sensor(model_pose(scan), shot.angle)};
}

SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop) {
  return {.count = scan.shots.size(), .read = [=](std::size_t i) {
            if (stop.stop_requested()) {
              throw Stopped{};
            }
            return read_snapshot(folder, scan, scan.shots[i]);
          }};
}

void write_scan(const std::filesystem::path& folder, const Scan& scan) {
  json calibration{{"platform_from_sensor", to_json(scan.platform_from_sensor)}};
  if (scan.solved) {
    calibration["solved"] = to_json(*scan.solved);
  }
  json shots = json::array();
  for (const Shot& shot : scan.shots) {
    shots.push_back({{"file", shot.file}, {"angle_deg", degrees_from_radians(shot.angle)}});
  }
  const auto point = [](const Eigen::Vector3d& p) { return json::array({p.x(), p.y(), p.z()}); };
  const json document{
      {"format", "octurn-scan"},
      {"version", 1},
      {"sensor",
       to_json(SensorJson{
           .name = scan.sensor_name, .serial = scan.sensor_serial, .intrinsics = scan.intrinsics})},
      {"calibration", calibration},
      {"clip_m", {{"min", point(scan.clip.min)}, {"max", point(scan.clip.max)}}},
      {"snapshots", shots},
  };
  write_document(folder, document);
}

void write_solved_pose(const std::filesystem::path& folder, const SolvedPose& solved) {
  const std::string text = read_bytes(folder / "scan.json");
  parse_scan(text);  // refuses what is no scan
  json document = parse_json(text, malformed, "scan.json");
  document["calibration"]["solved"] = to_json(solved);
  write_document(folder, document);
}

std::string shot_file(int index) {
  std::string number = std::to_string(index);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "snapshots/" + number + ".png";
}

}  // namespace octurn
