#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "octurn/quality.hpp"

namespace octurn {

/// A verdict as the API and `job.json` have it.
nlohmann::json to_json(const Quality& quality);

/// The verdict of such JSON. @throws Error  of the value's code
Quality to_quality(const JsonValue& object);

}  // namespace octurn
