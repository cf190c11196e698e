#include "io/sensor_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/laser_json.hpp"
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
