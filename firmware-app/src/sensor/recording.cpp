#include "sensor/recording.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/intrinsics_json.hpp"
#include "octurn/json_object.hpp"
#include "octurn/png.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* format = "octurn-recording";
constexpr ErrorCode malformed = ErrorCode::recording_malformed;
constexpr int format_version = 1;
constexpr double max_number = std::numeric_limits<double>::max();

std::string frame_file(std::size_t frame) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frames/%06zu.png", frame);
  return name.data();
}

Intrinsics intrinsics_from(JsonObject& sensor) {
  Intrinsics intrinsics = lens_from(sensor);
  intrinsics.width = sensor.at("width").whole_number(2, max_image_side);
  intrinsics.height = sensor.at("height").whole_number(2, max_image_side);
  intrinsics.depth_unit = depth_unit_from(sensor);
  return intrinsics;
}

RecordedFrame frame_from(const JsonValue& object) {
  JsonObject keys(object);
  RecordedFrame frame{
      .time = std::chrono::duration<double>(keys.at("time_s").number(0, max_number)),
      .angle = radians_from_degrees(keys.at("angle_deg").number(-360, 360)),
  };
  const auto pitch = keys.number("pitch_deg", -180, 180);
  const auto roll = keys.number("roll_deg", -180, 180);
  if (pitch && roll) {
    frame.tilt = Tilt{.pitch = radians_from_degrees(*pitch), .roll = radians_from_degrees(*roll)};
  }
  keys.refuse_unread();
  return frame;
}

json to_json(const RecordedFrame& frame) {
  json object{{"time_s", frame.time.count()}, {"angle_deg", degrees_from_radians(frame.angle)}};
  if (frame.tilt) {
    object["pitch_deg"] = degrees_from_radians(frame.tilt->pitch);
    object["roll_deg"] = degrees_from_radians(frame.tilt->roll);
  }
  return object;
}

json to_json(const Recording& recording) {
  const Intrinsics& camera = recording.intrinsics;
  json frames = json::array();
  for (const RecordedFrame& frame : recording.frames) {
    frames.push_back(to_json(frame));
  }
  json sensor{{"name", recording.sensor_name},
              {"width", camera.width},
              {"height", camera.height},
              {"fx", camera.fx},
              {"fy", camera.fy},
              {"cx", camera.cx},
              {"cy", camera.cy},
              {"depth_unit_m", camera.depth_unit}};
  if (!recording.sensor_serial.empty()) {
    sensor["serial"] = recording.sensor_serial;
  }
  return {{"format", format}, {"version", format_version}, {"sensor", sensor}, {"frames", frames}};
}

/// @throws Error "recording-malformed"  if it is missing, no file, too large, or its disk fails
std::string read_content(const fs::path& file) {
  constexpr std::size_t max_bytes = std::size_t{256} << 20U;
  try {
    if (std::optional<std::string> content = read_regular_file(file, max_bytes)) {
      return *std::move(content);
    }
  } catch (const Error& error) {
    throw Error(malformed, error.what(), error.hint());
  }
  throw Error(malformed, file.string() + ": is missing",
              "Give the folder that `octurn record` has made.");
}

}  // namespace

Recording parse_recording(std::string_view text) {
  const json object = parse_json(text, malformed, "it");
  JsonObject keys(object, malformed, "");
  if (keys.at("format").text() != format ||
      keys.at("version").whole_number(0, 1'000'000) != format_version) {
    throw Error(malformed, "it is no recording of a version that this program knows");
  }
  JsonObject sensor(keys.at("sensor"));
  Recording recording{.sensor_name = sensor.at("name").text(),
                      .sensor_serial = sensor.text("serial").value_or(""),
                      .intrinsics = intrinsics_from(sensor)};
  sensor.refuse_unread();
  const JsonValue frames = keys.at("frames");
  keys.refuse_unread();
  for (const JsonValue& frame : frames.elements()) {
    recording.frames.push_back(frame_from(frame));
  }
  if (recording.frames.empty()) {
    frames.refuse("an array with at least one frame");
  }
  return recording;
}

Recording read_recording(const fs::path& folder) {
  const fs::path file = folder / "recording.json";
  const std::string text = read_content(file);
  try {
    return parse_recording(text);
  } catch (const Error& error) {
    throw Error(error.code(), file.string() + ": " + error.what(), error.hint());
  }
}

DepthFrame read_recorded_frame(const fs::path& folder, const Recording& recording,
                               std::size_t frame) {
  const fs::path file = folder / frame_file(frame);
  const std::string png = read_content(file);
  return decode_depth_png(file.string(), std::as_bytes(std::span(png)), recording.intrinsics.width,
                          recording.intrinsics.height);
}

RecordingWriter::RecordingWriter(const fs::path& folder, std::string sensor_name,
                                 std::string sensor_serial, const Intrinsics& intrinsics)
    : folder_(folder),
      recording_{.sensor_name = std::move(sensor_name),
                 .sensor_serial = std::move(sensor_serial),
                 .intrinsics = intrinsics} {
  std::error_code ignored;  // writing the first frame reports a failure
  fs::create_directory(folder_.path() / "frames", ignored);
}

void RecordingWriter::write(const DepthFrame& frame, const RecordedFrame& about) {
  const fs::path file = folder_.path() / frame_file(recording_.frames.size());
  const std::vector<std::byte> png = encode_depth_png(frame);
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!stream.flush()) {
    throw Error(ErrorCode::write_failed, file.string() + ": cannot be written: is the disk full?",
                "Name a folder where this program may write.");
  }
  recording_.frames.push_back(about);
}

void RecordingWriter::commit() {
  write_file(folder_.path() / "recording.json", to_json(recording_).dump(1) + "\n");
  folder_.commit();
}

}  // namespace octurn
