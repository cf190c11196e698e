#include "octurn/scan_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "octurn/atomic_file.hpp"
#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/read_file.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int max_side = 8192;  // pixels; larger images than any depth sensor's are refused
constexpr std::size_t max_file_bytes = 256U << 20U;  // twice an uncompressed image of that size

[[noreturn]] void malformed(const std::string& what) {
  throw Error("scan-malformed", "scan.json: " + what,
              "The folder is not a scan that this version can read.");
}

std::string quoted(const std::string& key) { return "\"" + key + "\""; }

bool is_control(char character) { return static_cast<unsigned char>(character) < ' '; }

/// A value of scan.json and the dotted name of where it stands, for messages.
struct Value {
  const json& value;
  std::string name;

  Value at(const std::string& key) const {
    if (!value.is_object()) {
      malformed(quoted(name) + " is no object");
    }
    const auto found = value.find(key);
    const std::string inner = name.empty() ? key : name + "." + key;
    if (found == value.end()) {
      malformed(quoted(inner) + " is missing");
    }
    return {*found, inner};
  }

  Value at(std::size_t index) const {
    return {value.at(index), name + "[" + std::to_string(index) + "]"};
  }

  void expect_array(std::size_t size) const {
    if (!value.is_array() || value.size() != size) {
      malformed(quoted(name) + " is no array of " + std::to_string(size));
    }
  }

  double number() const {
    if (!value.is_number()) {
      malformed(quoted(name) + " is no number");
    }
    const auto number = value.get<double>();
    if (!std::isfinite(number)) {
      malformed(quoted(name) + " is not finite");
    }
    return number;
  }

  double positive() const {
    const double result = number();
    if (result <= 0) {
      malformed(quoted(name) + " is not above 0");
    }
    return result;
  }

  int pixels() const {
    const double side = number();
    if (!value.is_number_integer() || side < 2 || side > max_side) {
      malformed(quoted(name) + " is not a whole number from 2 to " + std::to_string(max_side));
    }
    return value.get<int>();
  }

  std::string text() const {
    if (!value.is_string()) {
      malformed(quoted(name) + " is no text");
    }
    return value.get<std::string>();
  }

  Eigen::Vector3d point() const {
    expect_array(3);
    return {at(0).number(), at(1).number(), at(2).number()};
  }
};

Intrinsics intrinsics_of(const Value& sensor) {
  return {.width = sensor.at("width").pixels(),
          .height = sensor.at("height").pixels(),
          .fx = sensor.at("fx").positive(),
          .fy = sensor.at("fy").positive(),
          .cx = sensor.at("cx").number(),
          .cy = sensor.at("cy").number(),
          .depth_unit = sensor.at("depth_unit_m").positive()};
}

Eigen::Isometry3d pose_of(const Value& matrix) {
  Eigen::Matrix4d pose;
  matrix.expect_array(4);
  for (int row = 0; row < 4; ++row) {
    const Value values = matrix.at(static_cast<std::size_t>(row));
    values.expect_array(4);
    for (int column = 0; column < 4; ++column) {
      pose(row, column) = values.at(static_cast<std::size_t>(column)).number();
    }
  }
  if (!is_rigid(pose)) {
    malformed(quoted(matrix.name) + " is no rotation and translation");
  }
  return Eigen::Isometry3d(pose);
}

Box clip_of(const Value& clip) {
  Box box{.min = clip.at("min").point(), .max = clip.at("max").point()};
  if ((box.min.array() >= box.max.array()).any()) {
    malformed(quoted(clip.name) + " is empty: its \"min\" is not below its \"max\"");
  }
  return box;
}

Shot shot_of(const Value& shot) {
  const Value file = shot.at("file");
  const std::string text = file.text();
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == ".." || !path.has_filename() ||
      path == "." || std::ranges::any_of(text, is_control)) {
    malformed(quoted(file.name) + " is " + file.value.dump() + ", not a file in the scan's folder");
  }
  return {.file = text, .angle = radians_from_degrees(shot.at("angle_deg").number())};
}

std::string read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error("scan-missing",
                file.string() + ": " + (error ? error.message() : "not a regular file"),
                "Name a folder that holds a whole scan.");
  }
  if (std::filesystem::file_size(file, error) > max_file_bytes) {
    throw Error("scan-malformed", file.string() + ": too large for a file of a scan");
  }
  return read_regular_file(file, max_file_bytes).value_or("");
}

}  // namespace

Scan parse_scan(std::string_view text) {
  const json document = parse_json(text, "scan-malformed", "scan.json");
  const Value root{document, ""};
  if (root.at("format").text() != "octurn-scan") {
    malformed("\"format\" is not \"octurn-scan\"");
  }
  if (const double version = root.at("version").number(); version != 1) {
    malformed("\"version\" is " + json(version).dump() + "; this program reads version 1");
  }

  const Value sensor = root.at("sensor");
  Scan scan{.sensor_name = sensor.at("name").text(),
            .intrinsics = intrinsics_of(sensor),
            .platform_from_sensor = pose_of(root.at("calibration").at("platform_from_sensor")),
            .clip = clip_of(root.at("clip_m")),
            .shots = {}};
  const Value shots = root.at("snapshots");
  if (!shots.value.is_array()) {
    malformed("\"snapshots\" is no array");
  }
  for (std::size_t i = 0; i < shots.value.size(); ++i) {
    scan.shots.push_back(shot_of(shots.at(i)));
  }
  if (scan.shots.empty()) {
    throw Error("scan-empty", "scan.json: \"snapshots\" is empty: there is nothing to reconstruct");
  }
  return scan;
}

Scan read_scan(const std::filesystem::path& folder) {
  return parse_scan(read_bytes(folder / "scan.json"));
}

Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot) {
  const Intrinsics& lens = scan.intrinsics;
  const std::string png = read_bytes(folder / shot.file);
  return {
      .frame = decode_depth_png(shot.file, std::as_bytes(std::span(png)), lens.width, lens.height),
      .intrinsics = lens,
      .object_from_sensor = object_from_sensor(scan.platform_from_sensor, shot.angle)};
}

void write_scan(const std::filesystem::path& folder, const Scan& scan) {
  const Intrinsics& lens = scan.intrinsics;
  const Eigen::Matrix4d& pose = scan.platform_from_sensor.matrix();
  json matrix = json::array();
  for (int row = 0; row < 4; ++row) {
    matrix.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
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
        {"width", lens.width},
        {"height", lens.height},
        {"fx", lens.fx},
        {"fy", lens.fy},
        {"cx", lens.cx},
        {"cy", lens.cy},
        {"depth_unit_m", lens.depth_unit}}},
      {"calibration", {{"platform_from_sensor", matrix}}},
      {"clip_m", {{"min", point(scan.clip.min)}, {"max", point(scan.clip.max)}}},
      {"snapshots", shots},
  };
  // A device may call itself by bytes that are no UTF-8; they are replaced.
  write_file(folder / "scan.json",
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

std::string shot_file(int index) {
  std::string number = std::to_string(index);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "snapshots/" + number + ".png";
}

void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame) {
  const std::vector<std::byte> png = encode_depth_png(frame);
  std::error_code ignored;  // if the folder cannot be made, opening the file says why
  std::filesystem::create_directories(file.parent_path(), ignored);
  AtomicFile target(file);
  target.write(png);
  target.commit();
}

}  // namespace octurn
