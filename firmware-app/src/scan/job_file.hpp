#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "scan/job.hpp"

namespace octurn {

/// A hundred times what is written.
inline constexpr std::size_t max_job_bytes = std::size_t{1} << 20U;

/// A scan as `job.json` has it. A reader passes over keys that it does not know, and every version
/// of this program reads what an earlier one wrote.
nlohmann::json to_job_json(const Job& job);

/// The scan of a `job.json`.
/// @throws Error "job-malformed"  that says what is missing or wrong
Job to_job(const nlohmann::json& object);

}  // namespace octurn
