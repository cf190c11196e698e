#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "io/png_file.hpp"
#include "io/sensor_json.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/optics_json.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr const char* map_keyword = "octurn-sensor-map";
constexpr const char* hint = "Make it again with `octurn calibrate --wall`.";

constexpr std::uint32_t max_map_side = 4096;        // pixels
constexpr std::size_t max_map_bytes = 128U << 20U;  // twice two uncompressed images of that size
constexpr std::size_t max_map_values = 1000;        // of its text, which has about ten
constexpr double step = 1e-5;                       // 1/m, a unit of the samples
constexpr int zero = 1 << 15;                       // the sample of error 0
constexpr double max_inverse_depth = 100;           // 1/m

/// Appends the samples of a plane of the map.
void append(std::vector<std::uint16_t>& samples, const std::vector<float>& plane) {
  for (const float error : plane) {
    const double rounded = std::round(static_cast<double>(error) / step) + zero;
    samples.push_back(static_cast<std::uint16_t>(
        std::clamp(rounded, 0.0, double{std::numeric_limits<std::uint16_t>::max()})));
  }
}

std::vector<float> to_plane(std::span<const std::uint16_t> samples) {
  std::vector<float> plane;
  plane.reserve(samples.size());
  for (const std::uint16_t sample : samples) {
    plane.push_back(static_cast<float>((sample - zero) * step));
  }
  return plane;
}

json to_document(const SensorMap& map) {
  json inverse_depths{map.near_inverse_depth};
  if (!map.far.empty()) {
    inverse_depths.push_back(map.far_inverse_depth);
  }
  json document{{"version", 1},         {"inverse_depths", std::move(inverse_depths)},
                {"serial", map.serial}, {"made", map.made},
                {"before", map.before}, {"after", map.after}};
  if (map.optics) {
    document["optics"] = to_json(*map.optics);
  }
  if (map.on_for) {
    document["on_for_s"] = *map.on_for;
  }
  return document;
}

/// Reads the text of a map. The planes stay empty; `far_inverse_depth` is 0 if there is only one.
SensorMap from_json(const json& document) {
  JsonObject keys(document, ErrorCode::scan_malformed, "");
  if (const JsonValue version = keys.at("version"); version.number() != 1) {
    version.refuse("1, which this program reads");
  }
  SensorMap map{.serial = keys.at("serial").text(),
                .made = keys.at("made").text(),
                .before = keys.at("before").number(0, max_inverse_depth),
                .after = keys.at("after").number(0, max_inverse_depth)};
  if (const auto optics = keys.value("optics")) {
    map.optics = optics_from(*optics);
  }
  map.on_for = keys.number("on_for_s", 0, max_on_for);
  const JsonValue depths = keys.at("inverse_depths");
  const std::vector<JsonValue> values = depths.elements();
  if (values.empty() || values.size() > 2) {
    depths.refuse("one number, or two");
  }
  map.near_inverse_depth = values[0].number(0, max_inverse_depth);
  if (values.size() == 2) {
    map.far_inverse_depth = values[1].number(0, max_inverse_depth);
    if (map.far_inverse_depth >= map.near_inverse_depth) {
      depths.refuse("the nearer first");
    }
  }
  return map;
}

}  // namespace

std::vector<std::byte> encode_sensor_map(const SensorMap& map) {
  const auto pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  if (map.near.size() != pixels || (!map.far.empty() && map.far.size() != pixels)) {
    throw std::invalid_argument("encode_sensor_map: there are not width x height errors");
  }
  std::vector<std::uint16_t> samples;
  append(samples, map.near);
  append(samples, map.far);
  return encode_grey_png(
      map.width, map.far.empty() ? map.height : 2 * map.height,
      std::span<const std::uint16_t>(samples),
      {.keyword = map_keyword,
       .text = to_document(map).dump(-1, ' ', true, json::error_handler_t::replace)});
}

namespace {

using ExpectSize = std::function<void(std::uint32_t width, std::uint32_t height)>;

/// @param expect_size  called with the picture's size before pixels are allocated
SensorMap decode_map(const PngSource& source, const ExpectSize& expect_size) {
  const GreyPng image = decode_grey16_png(source, map_keyword, expect_size);
  if (image.text.empty()) {
    source.refuse("a picture, but no map of a sensor");
  }
  SensorMap map;
  try {
    map = from_json(
        parse_json(image.text, ErrorCode::scan_malformed, "its text", {.values = max_map_values}));
  } catch (const Error& error) {
    source.refuse(error.what());
  }
  const int planes = map.far_inverse_depth > 0 ? 2 : 1;
  if (image.height % planes != 0) {
    source.refuse("two maps do not fit in " + std::to_string(image.height) + " rows");
  }
  map.width = image.width;
  map.height = image.height / planes;
  const std::span<const std::uint16_t> samples(image.samples);
  const std::size_t pixels = samples.size() / static_cast<std::size_t>(planes);
  map.near = to_plane(samples.first(pixels));
  map.far = to_plane(samples.subspan(pixels));
  return map;
}

PngSource map_source(std::string_view name, std::span<const std::byte> png) {
  return {.name = name, .bytes = png, .malformed = ErrorCode::scan_malformed, .hint = hint};
}

std::string read_map_file(const std::filesystem::path& file) {
  std::optional<std::string> bytes;
  try {
    bytes = read_regular_file(file, max_map_bytes);
  } catch (const Error& error) {
    throw Error(ErrorCode::scan_malformed, error.what(), error.hint());
  }
  if (!bytes) {
    throw Error(ErrorCode::scan_malformed, file.string() + ": no such file",
                "Make one with `octurn calibrate --wall`.");
  }
  return *std::move(bytes);
}

}  // namespace

SensorMap decode_sensor_map(std::string_view name, std::span<const std::byte> png) {
  const PngSource source = map_source(name, png);
  return decode_map(source, [&](std::uint32_t width, std::uint32_t height) {
    if (width > max_map_side || height > 2 * max_map_side) {
      source.refuse(size_text(width, height) + ": larger than any sensor's");
    }
  });
}

SensorMap read_sensor_map(const std::filesystem::path& file) {
  const std::string bytes = read_map_file(file);
  return decode_sensor_map(file.string(), std::as_bytes(std::span(bytes)));
}

SensorMap read_sensor_map(const std::filesystem::path& file, const Intrinsics& sensor) {
  const std::string bytes = read_map_file(file);
  const auto refuse_size = [&] {
    throw Error(ErrorCode::scan_malformed,
                file.string() + ": is for another sensor than the scan's: it has another size",
                "Take the map of the sensor that made the scan.");
  };
  const std::string name = file.string();
  SensorMap map = decode_map(map_source(name, std::as_bytes(std::span(bytes))),
                             [&](std::uint32_t width, std::uint32_t height) {
                               const auto rows = static_cast<std::uint32_t>(sensor.height);
                               if (width != static_cast<std::uint32_t>(sensor.width) ||
                                   (height != rows && height != 2 * rows)) {
                                 refuse_size();
                               }
                             });
  if (map.height != sensor.height) {
    refuse_size();
  }
  return map;
}

void write_sensor_map(const std::filesystem::path& file, const SensorMap& map) {
  write_png(file, encode_sensor_map(map));
}

}  // namespace octurn
