#include "scan/pose_of_json.hpp"

#include <nlohmann/json.hpp>

#include "octurn/units.hpp"
#include "scan/pose_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

PoseRegistration to_registration(const JsonValue& object) {
  JsonObject keys(object);
  PoseRegistration registration{.accepted = keys.at("accepted").flag(),
                                .reason = keys.at("reason").text()};
  if (registration.accepted) {
    const auto metres = [&](std::string_view key) { return metres_from_mm(keys.at(key).number()); };
    registration.pose = {.object_from_platform = to_pose(keys.at("object_from_platform")),
                         .position_sigma = metres("sigma_mm"),
                         .direction_sigma = radians_from_degrees(keys.at("sigma_deg").number()),
                         .overlap = keys.at("overlap").number(0, 1),
                         .residual = metres("residual_mm"),
                         .contradiction = keys.at("contradiction").number(0, 2),
                         .symmetric = keys.at("symmetric").flag()};
  }
  return registration;
}

}  // namespace

json to_json(const PoseRegistration& registration) {
  json object{{"accepted", registration.accepted}, {"reason", registration.reason}};
  if (registration.accepted) {
    const RegisteredPose& pose = registration.pose;
    object.update({{"object_from_platform", to_rows(pose.object_from_platform)},
                   {"sigma_mm", mm_from_metres(pose.position_sigma)},
                   {"sigma_deg", degrees_from_radians(pose.direction_sigma)},
                   {"overlap", pose.overlap},
                   {"residual_mm", mm_from_metres(pose.residual)},
                   {"contradiction", pose.contradiction},
                   {"symmetric", pose.symmetric}});
  }
  return object;
}

json to_json(const PoseOf& pose_of) {
  return {{"scan", pose_of.scan},
          {"registration", pose_of.registration ? to_json(*pose_of.registration) : json()}};
}

PoseOf to_pose_of(const JsonValue& object) {
  JsonObject keys(object);
  PoseOf pose_of{.scan = keys.at("scan").text()};
  if (const JsonValue registration = keys.at("registration"); !registration.json().is_null()) {
    pose_of.registration = to_registration(registration);
  }
  return pose_of;
}

}  // namespace octurn
