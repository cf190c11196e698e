#pragma once

#include <nlohmann/json_fwd.hpp>

#include "failure.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// A failure as the API and `job.json` have it.
nlohmann::json to_json(const Failure& failure);

/// The failure of such JSON. @throws Error  of the value's code
Failure to_failure(const JsonValue& object);

}  // namespace octurn
