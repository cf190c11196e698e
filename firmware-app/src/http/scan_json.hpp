#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scan/job.hpp"

namespace octurn {

/// A scan as web/API.md has it, but for its preview.
nlohmann::json to_json(const Job& job);

}  // namespace octurn
