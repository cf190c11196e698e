#include "store/pose_of_json.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/units.hpp"
#include "settings/pose_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

RegistrationCandidate to_candidate(const JsonValue& object) {
  JsonObject keys(object);
  return {.object_from_platform = to_pose(keys.at("object_from_platform")),
          .overlap = keys.at("overlap").number(0, 1),
          .residual = metres_from_mm(keys.at("residual_mm").number()),
          .contradiction = keys.at("contradiction").number(0, 2)};
}

/// Reads the candidates and the chosen one, which earlier versions did not write.
void read_candidates(JsonObject& keys, PoseRegistration& registration) {
  if (const auto candidates = keys.value("candidates")) {
    for (const JsonValue& candidate : candidates->elements()) {
      registration.candidates.push_back(to_candidate(candidate));
    }
  }
  const auto chosen = keys.value("candidate");
  if (chosen && !chosen->json().is_null()) {
    const auto count = static_cast<int>(registration.candidates.size());
    registration.candidate = static_cast<std::size_t>(chosen->whole_number(0, count - 1));
  }
}

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
  read_candidates(keys, registration);
  return registration;
}

}  // namespace

json to_json(const RegistrationCandidate& candidate) {
  return {{"object_from_platform", to_rows(candidate.object_from_platform)},
          {"overlap", candidate.overlap},
          {"residual_mm", mm_from_metres(candidate.residual)},
          {"contradiction", candidate.contradiction}};
}

json to_json(const PoseRegistration& registration) {
  json candidates = json::array();
  for (const RegistrationCandidate& candidate : registration.candidates) {
    candidates.push_back(to_json(candidate));
  }
  json object{{"accepted", registration.accepted},
              {"reason", registration.reason},
              {"candidates", std::move(candidates)},
              {"candidate", registration.candidate ? json(*registration.candidate) : json()}};
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
  json object{{"scan", pose_of.scan},
              {"registration", pose_of.registration ? to_json(*pose_of.registration) : json()}};
  if (pose_of.removed_build) {
    object["removed_build"] = *pose_of.removed_build;
  }
  return object;
}

PoseOf to_pose_of(const JsonValue& object) {
  JsonObject keys(object);
  PoseOf pose_of{
      .scan = keys.at("scan").text(),
      .removed_build = keys.whole_number("removed_build", 0, std::numeric_limits<int>::max())};
  if (const JsonValue registration = keys.at("registration"); !registration.json().is_null()) {
    pose_of.registration = to_registration(registration);
  }
  return pose_of;
}

}  // namespace octurn
