#include "octurn/intrinsics_json.hpp"

namespace octurn {

Intrinsics lens_from(JsonObject& keys) {
  return {.fx = keys.at("fx").number(min_focal, max_focal),
          .fy = keys.at("fy").number(min_focal, max_focal),
          .cx = keys.at("cx").number(-max_image_side, max_image_side),
          .cy = keys.at("cy").number(-max_image_side, max_image_side)};
}

double depth_unit_from(JsonObject& keys) {
  return keys.at("depth_unit_m").number(min_depth_unit, max_depth_unit);
}

}  // namespace octurn
