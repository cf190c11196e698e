#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "scan/job.hpp"

namespace octurn {

/// A pose to choose, as the API and `job.json` have it: millimetres.
nlohmann::json to_json(const RegistrationCandidate& candidate);

/// How a pose was registered, as the API and `job.json` have it: millimetres and degrees.
nlohmann::json to_json(const PoseRegistration& registration);

/// The link of a scan of another pose, as in `job.json` and the API.
nlohmann::json to_json(const PoseOf& pose_of);

/// The same of a `job.json`. @throws Error  of the value's code
PoseOf to_pose_of(const JsonValue& object);

}  // namespace octurn
