#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "store/job.hpp"

namespace octurn {

/// JSON of a registration's candidate, for the API and `job.json`: its pose in metres, its residual
/// in millimetres.
nlohmann::json to_json(const RegistrationCandidate& candidate);

/// JSON of a registration, for the API and `job.json`: poses in metres, residual and sigmas in
/// millimetres and degrees.
nlohmann::json to_json(const PoseRegistration& registration);

/// JSON of the link from another pose's scan to the first scan, for the API and `job.json`.
nlohmann::json to_json(const PoseOf& pose_of);

/// Parses that JSON. @throws Error  with the code of `object`
PoseOf to_pose_of(const JsonValue& object);

}  // namespace octurn
