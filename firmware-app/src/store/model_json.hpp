#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "store/job.hpp"

namespace octurn {

/// JSON of a model, for the API, `job.json` and `build.json`.
nlohmann::json to_json(const Model& model);

/// Parses that JSON, also of earlier versions. @throws Error  with the code of `object`
Model to_model(const JsonValue& object);

}  // namespace octurn
