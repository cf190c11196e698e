#include "octurn/optics_json.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "octurn/intrinsics_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr double min_depth_scale = 0.5;
constexpr double max_depth_scale = 2;
constexpr double max_depth_offset = 1;  // 1/m: a Kinect's nearest reading is 2 1/m

SensorOptics sigma_from(const JsonValue& object) {
  JsonObject keys(object);
  const auto sigma = [&](std::string_view key) {
    return keys.at(key).number(0, std::numeric_limits<double>::max());
  };
  return {.fx = sigma("fx"),
          .fy = sigma("fy"),
          .cx = sigma("cx"),
          .cy = sigma("cy"),
          .k1 = sigma("k1"),
          .k2 = sigma("k2"),
          .depth_scale = sigma("depth_scale"),
          .depth_offset_per_m = sigma("depth_offset_per_m")};
}

}  // namespace

json to_json(const SensorOptics& optics) {
  return {{"fx", optics.fx},
          {"fy", optics.fy},
          {"cx", optics.cx},
          {"cy", optics.cy},
          {"k1", optics.k1},
          {"k2", optics.k2},
          {"depth_scale", optics.depth_scale},
          {"depth_offset_per_m", optics.depth_offset_per_m}};
}

SensorOptics optics_from(const JsonValue& object) {
  JsonObject keys(object);
  const Intrinsics lens = lens_from(keys);
  return {.fx = lens.fx,
          .fy = lens.fy,
          .cx = lens.cx,
          .cy = lens.cy,
          .k1 = keys.at("k1").number(-max_distortion, max_distortion),
          .k2 = keys.at("k2").number(-max_distortion, max_distortion),
          .depth_scale = keys.at("depth_scale").number(min_depth_scale, max_depth_scale),
          .depth_offset_per_m =
              keys.at("depth_offset_per_m").number(-max_depth_offset, max_depth_offset)};
}

json to_json(const SolvedOptics& optics) {
  json object = to_json(optics.value);
  object["sigma"] = to_json(optics.sigma);
  return object;
}

SolvedOptics solved_optics_from(const JsonValue& object) {
  JsonObject keys(object);
  return {.value = optics_from(object), .sigma = sigma_from(keys.at("sigma"))};
}

}  // namespace octurn
