#include "calibration/sensor_map_files.hpp"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <numeric>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_map_bytes = 16U << 20U;
constexpr int block = 8;  // pixels per side: the error pattern has a wavelength of about 50

constexpr std::string_view allowed =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";

using nlohmann::json;

double to_units(double inverse_depth) { return inverse_depth / disparity_unit; }

}  // namespace

std::filesystem::path sensor_map_path(const std::filesystem::path& data, std::string_view serial) {
  std::string name(serial);
  for (char& letter : name) {
    letter = allowed.find(letter) == allowed.npos ? '_' : letter;
  }
  return data / "sensor-maps" / (name + ".png");
}

std::filesystem::path wall_views_path(const std::filesystem::path& data, std::string_view serial) {
  return sensor_map_path(data, serial).replace_extension();
}

void remove_sensor_map(const std::filesystem::path& data, std::string_view serial) {
  const std::filesystem::path map = sensor_map_path(data, serial);
  std::error_code failed_map;
  std::error_code failed_views;
  std::filesystem::remove(map, failed_map);
  std::filesystem::remove_all(wall_views_path(data, serial), failed_views);
  if (const std::error_code& failed = failed_map ? failed_map : failed_views) {
    throw Error(ErrorCode::write_failed, map.string() + ": cannot be removed: " + failed.message(),
                "Look at the disk.");
  }
}

SensorMapSummary summarise(const SensorMap& map) {
  SensorMapSummary summary{.serial = map.serial,
                           .made = map.made,
                           .before = map.before,
                           .after = map.after,
                           .on_for = map.on_for,
                           .columns = map.width / block,
                           .rows = map.height / block,
                           .errors = {}};
  for (int row = 0; row < summary.rows; ++row) {
    for (int column = 0; column < summary.columns; ++column) {
      float sum = 0;
      for (int v = row * block; v < (row + 1) * block; ++v) {
        const auto first =
            map.near.begin() + std::ptrdiff_t{v} * map.width + std::ptrdiff_t{column} * block;
        sum = std::accumulate(first, first + block, sum);
      }
      summary.errors.push_back(sum / (block * block));
    }
  }
  return summary;
}

std::optional<SensorMapSummary> find_map_summary(const std::filesystem::path& data,
                                                 std::string_view serial) {
  const std::filesystem::path file = sensor_map_path(data, serial);
  return serial.empty() || !std::filesystem::exists(file)
             ? std::nullopt
             : std::optional(summarise(read_sensor_map(file)));
}

void keep_sensor_map(const std::filesystem::path& data, std::string_view serial,
                     const std::filesystem::path& folder) {
  if (serial.empty()) {
    return;
  }
  if (const std::optional<std::string> map =
          read_regular_file(sensor_map_path(data, serial), max_map_bytes)) {
    write_file(folder / sensor_map_file, *map);
  }
}

json to_json(const SensorMapReport& report) {
  json walls = json::array();
  for (const WallReport& wall : report.walls) {
    walls.push_back({{"distance_m", wall.distance},
                     {"slant_deg", degrees_from_radians(wall.slant)},
                     {"coverage", wall.coverage},
                     {"rms_before", to_units(wall.before)},
                     {"rms_after", to_units(wall.after)}});
  }
  return {{"accepted", report.accepted},
          {"reason", report.reason},
          {"serial", report.map.serial},
          {"unit_per_m", disparity_unit},
          {"rms_before", report.accepted ? json(to_units(report.map.before)) : json()},
          {"rms_after", report.accepted ? json(to_units(report.map.after)) : json()},
          {"walls", std::move(walls)}};
}

json to_json(const SensorMapSummary& map) {
  return {{"serial", map.serial},
          {"at", map.made},
          {"on_for_s", map.on_for ? json(*map.on_for) : json()},
          {"rms_before", to_units(map.before)},
          {"rms_after", to_units(map.after)}};
}

json to_picture(const SensorMapSummary& map) {
  json errors = json::array();
  for (const float error : map.errors) {
    errors.push_back(std::round(100 * to_units(static_cast<double>(error))) / 100);
  }
  return {{"columns", map.columns}, {"rows", map.rows}, {"errors", std::move(errors)}};
}

}  // namespace octurn
