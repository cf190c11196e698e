#include "octurn/scan_folder.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int max_side = 8192;  // pixels; larger images than any depth sensor's are refused
constexpr std::size_t max_file_bytes = 256U << 20U;  // twice an uncompressed image of that size

constexpr ErrorCode malformed = ErrorCode::scan_malformed;

bool is_control(char character) { return static_cast<unsigned char>(character) < ' '; }

double positive_in(JsonObject& keys, std::string_view key) {
  const JsonValue value = keys.at(key);
  if (value.number() <= 0) {
    value.refuse("above 0");
  }
  return value.number();
}

Intrinsics intrinsics_from(JsonObject& sensor) {
  return {.width = sensor.at("width").whole_number(2, max_side),
          .height = sensor.at("height").whole_number(2, max_side),
          .fx = positive_in(sensor, "fx"),
          .fy = positive_in(sensor, "fy"),
          .cx = sensor.at("cx").number(),
          .cy = sensor.at("cy").number(),
          .depth_unit = positive_in(sensor, "depth_unit_m")};
}

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
  const JsonValue file = keys.at("file");
  const std::string text = file.text();
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == ".." || !path.has_filename() ||
      path == "." || std::ranges::any_of(text, is_control)) {
    file.refuse("a file in the scan's folder");
  }
  return {.file = text, .angle = radians_from_degrees(keys.at("angle_deg").number())};
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
  JsonObject sensor(root.at("sensor"));
  JsonObject calibration(root.at("calibration"));
  Scan scan{.sensor_name = sensor.at("name").text(),
            .intrinsics = intrinsics_from(sensor),
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
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error(ErrorCode::scan_missing,
                file.string() + ": " + (error ? error.message() : "not a regular file"),
                "Name a folder that holds a whole scan.");
  }
  if (std::filesystem::file_size(file, error) > max_file_bytes) {
    throw Error(malformed, file.string() + ": too large for a file of a scan");
  }
  return read_regular_file(file, max_file_bytes).value_or("");
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
  return parse_scan(read_bytes(folder / "scan.json"));
}

Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot) {
  const Intrinsics& intrinsics = scan.intrinsics;
  const std::string png = read_bytes(folder / shot.file);
  return {.frame = decode_depth_png(shot.file, std::as_bytes(std::span(png)), intrinsics.width,
                                    intrinsics.height),
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
  const Intrinsics& intrinsics = scan.intrinsics;
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
       {{"name", scan.sensor_name},
        {"width", intrinsics.width},
        {"height", intrinsics.height},
        {"fx", intrinsics.fx},
        {"fy", intrinsics.fy},
        {"cx", intrinsics.cx},
        {"cy", intrinsics.cy},
        {"depth_unit_m", intrinsics.depth_unit}}},
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
