#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// The values of a message as the API and `job.json` have them: an object of numbers and texts.
nlohmann::json to_json(const Parameters& parameters);

/// The values of such JSON; none of nothing. @throws Error  of the value's code
Parameters to_parameters(const std::optional<JsonValue>& object);

}  // namespace octurn
