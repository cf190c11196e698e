#include "io/sensor_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/laser_json.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

constexpr int max_image_side = 8192;                  // pixels; no depth sensor's image is larger
constexpr std::size_t max_image_bytes = 256U << 20U;  // twice an uncompressed image of that size

bool is_control(char character) { return static_cast<unsigned char>(character) < ' '; }

double positive_in(JsonObject& keys, std::string_view key) {
  const JsonValue value = keys.at(key);
  if (value.number() <= 0) {
    value.refuse("above 0");
  }
  return value.number();
}

}  // namespace

SensorJson sensor_from(const JsonValue& object) {
  JsonObject keys(object);
  const auto kind = keys.value("kind");
  if (kind && kind->text() != "laser-line") {
    kind->refuse("\"laser-line\", or left out for a sensor that measures depth");
  }
  SensorJson sensor{.name = keys.at("name").text(),
                    .serial = {},
                    .intrinsics = {.width = keys.at("width").whole_number(2, max_image_side),
                                   .height = keys.at("height").whole_number(2, max_image_side),
                                   .fx = positive_in(keys, "fx"),
                                   .fy = positive_in(keys, "fy"),
                                   .cx = keys.at("cx").number(),
                                   .cy = keys.at("cy").number()}};
  if (kind) {
    sensor.laser = laser_camera_from(keys, sensor.intrinsics);
  } else {
    sensor.intrinsics.depth_unit = positive_in(keys, "depth_unit_m");
  }
  sensor.serial = keys.text("serial").value_or("");
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
  }
  if (!sensor.serial.empty()) {
    object["serial"] = sensor.serial;
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

}  // namespace octurn
