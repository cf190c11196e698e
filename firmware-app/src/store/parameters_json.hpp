#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// JSON of a message's values, for the API and `job.json`: an object of numbers and strings.
nlohmann::json to_json(const Parameters& parameters);

/// Parses that JSON; nullopt gives no values. @throws Error  with the code of `object`
Parameters to_parameters(const std::optional<JsonValue>& object);

}  // namespace octurn
