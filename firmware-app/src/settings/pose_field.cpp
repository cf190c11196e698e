#include "settings/pose_field.hpp"

#include <nlohmann/json.hpp>

#include "settings/pose_json.hpp"

namespace octurn {

Access pose(Eigen::Isometry3d& value) {
  const nlohmann::json row{{"type", "array"}, {"items", {{"type", "number"}}}};
  return {.read = [&value](const JsonValue& given) { value = to_pose(given); },
          .write = [&value] { return to_rows(value); },
          .schema = {{"type", "array"}, {"items", row}}};
}

}  // namespace octurn
