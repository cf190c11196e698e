#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "scan/job.hpp"

namespace octurn {

/// Maximum size of `job.json`: 100 times the usual size.
inline constexpr std::size_t max_job_bytes = std::size_t{1} << 20U;

/// Returns the content of a scan's `job.json`. Readers ignore unknown keys, and every version of
/// this program reads the files of earlier ones.
nlohmann::json to_job_json(const Job& job);

/// Parses a scan's `job.json`.
/// @throws Error "job-malformed"  with the key that is missing or wrong
Job to_job(const nlohmann::json& object);

}  // namespace octurn
