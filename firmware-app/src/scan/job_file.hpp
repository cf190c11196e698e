#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "scan/job.hpp"

namespace octurn {

/// A hundred times what is written.
inline constexpr std::size_t max_job_bytes = std::size_t{1} << 20U;

/// The content of a scan's `job.json`. Readers ignore unknown keys, and every version of this
/// program reads the files of earlier ones.
nlohmann::json to_job_json(const Job& job);

/// The scan of a `job.json`.
/// @throws Error "job-malformed"  with the key that is missing or wrong
Job to_job(const nlohmann::json& object);

}  // namespace octurn
