#include "calibration/sensor_map_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

double to_units(double inverse_depth) { return inverse_depth / disparity_unit; }

}  // namespace

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
