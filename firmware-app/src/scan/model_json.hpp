#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "scan/job.hpp"

namespace octurn {

/// A model as the API, `job.json` and `build.json` have it.
nlohmann::json to_json(const Model& model);

/// The model of such JSON, also of an earlier version. @throws Error  of the value's code
Model to_model(const JsonValue& object);

}  // namespace octurn
