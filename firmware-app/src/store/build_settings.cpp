#include "store/build_settings.hpp"

#include <nlohmann/json.hpp>

#include "settings/pose_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Access optional_pose(std::optional<Eigen::Isometry3d>& value) {
  const json row{{"type", "array"}, {"items", {{"type", "number"}}}};
  return {.read =
              [&value](const JsonValue& given) {
                value = given.json().is_null() ? std::nullopt : std::optional(to_pose(given));
              },
          .write = [&value] { return value ? to_rows(*value) : json(); },
          .schema = {{"type", "array"}, {"items", row}}};
}

}  // namespace

std::vector<Field> fields(BuildSettings& settings, const SettingRanges& ranges) {
  std::vector<Field> all = model_fields(settings.scan, ranges);
  all.push_back({.key = "level",
                 .help = "surface of a coarser level; 0 is the root",
                 .access = whole(settings.level, 0, max_levels),
                 .method = "intersection",
                 .default_text = "the leaves'"});
  all.push_back(
      {.key = "platform_from_sensor",
       .unit = "m",
       .help = "pose of the sensor, four rows of four numbers, in place of the configured one",
       .access = optional_pose(settings.platform_from_sensor),
       .default_text = "the scan's"});
  return all;
}

json to_json(const BuildSettings& settings) {
  BuildSettings copy = settings;
  return to_json(fields(copy));
}

BuildSettings build_settings_from(const json& object, const BuildSettings& defaults) {
  JsonObject keys(object, ErrorCode::bad_settings, "");
  BuildSettings settings = defaults;
  read_fields(keys, fields(settings));
  check_leaf(keys, settings.scan);
  check_clip(keys, settings.scan);
  keys.refuse_unread();
  return settings;
}

BuildSettings stored_build_settings_from(const JsonValue& object) {
  JsonObject keys(object);
  BuildSettings settings;
  read_fields(keys, fields(settings, stored_ranges));
  keys.refuse_unread();
  return settings;
}

}  // namespace octurn
