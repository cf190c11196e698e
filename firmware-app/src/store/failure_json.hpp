#pragma once

#include <nlohmann/json_fwd.hpp>

#include "failure.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// JSON of a failure, for the API and `job.json`.
nlohmann::json to_json(const Failure& failure);

/// Parses that JSON. @throws Error  with the code of `object`
Failure to_failure(const JsonValue& object);

}  // namespace octurn
