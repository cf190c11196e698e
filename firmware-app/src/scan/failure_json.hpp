#pragma once

#include <nlohmann/json_fwd.hpp>

#include "failure.hpp"

namespace octurn {

/// A failure as the API and `job.json` have it.
nlohmann::json to_json(const Failure& failure);

}  // namespace octurn
