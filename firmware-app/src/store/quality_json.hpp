#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "octurn/quality.hpp"

namespace octurn {

/// JSON of a verdict, for the API and `job.json`.
nlohmann::json to_json(const Quality& quality);

/// Parses that JSON. @throws Error  with the code of `object`
Quality to_quality(const JsonValue& object);

}  // namespace octurn
