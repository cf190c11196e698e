#include <nlohmann/json.hpp>

#include "io/sensor_json.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/png.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

using nlohmann::json;

std::string read_wall_bytes(const std::filesystem::path& file) {
  return read_bytes(file, ErrorCode::recording_malformed, "Record one with `octurn record --wall`.",
                    ErrorCode::recording_malformed);
}

Wall wall_from(const json& document) {
  JsonObject root(document, ErrorCode::recording_malformed, "");
  if (const JsonValue format = root.at("format"); format.text() != "octurn-wall") {
    format.refuse("\"octurn-wall\"");
  }
  if (const JsonValue version = root.at("version"); version.number() != 1) {
    version.refuse("1, which this program reads");
  }
  const JsonValue of_sensor = root.at("sensor");
  SensorJson sensor = sensor_from(of_sensor);
  if (sensor.laser) {
    of_sensor.refuse("one that measures depth");
  }
  Wall wall{.sensor_name = std::move(sensor.name),
            .sensor_serial = std::move(sensor.serial),
            .intrinsics = sensor.intrinsics,
            .sensor_on_for = sensor.on_for,
            .frames = {}};
  const JsonValue frames = root.at("frames");
  for (const JsonValue& frame : frames.elements()) {
    wall.frames.push_back(file_inside(frame, "a file in the wall's folder"));
  }
  if (wall.frames.empty()) {
    frames.refuse("an array with at least one frame");
  }
  return wall;
}

}  // namespace

Wall parse_wall(std::string_view text) {
  try {
    return wall_from(parse_json(text, ErrorCode::recording_malformed, "it"));
  } catch (const Error& error) {
    throw Error(ErrorCode::recording_malformed, std::string("wall.json: ") + error.what(),
                "The folder is not a wall that this version can read.");
  }
}

Wall read_wall(const std::filesystem::path& folder) {
  return parse_wall(read_wall_bytes(folder / "wall.json"));
}

DepthFrame read_wall_frame(const std::filesystem::path& folder, const Wall& wall,
                           std::size_t frame) {
  const std::string& file = wall.frames.at(frame);
  const std::string png = read_wall_bytes(folder / file);
  return decode_depth_png(file, std::as_bytes(std::span(png)), wall.intrinsics.width,
                          wall.intrinsics.height);
}

void write_wall(const std::filesystem::path& folder, const Wall& wall) {
  const json document{{"format", "octurn-wall"},
                      {"version", 1},
                      {"sensor", to_json(SensorJson{.name = wall.sensor_name,
                                                    .serial = wall.sensor_serial,
                                                    .intrinsics = wall.intrinsics,
                                                    .on_for = wall.sensor_on_for})},
                      {"frames", wall.frames}};
  write_file(folder / "wall.json",
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

std::string wall_frame_file(int index) {
  std::string number = std::to_string(index);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "frames/" + number + ".png";
}

}  // namespace octurn
