#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "store/job.hpp"

namespace octurn {

/// Maximum size of `job.json`: 100 times the usual size.
inline constexpr std::size_t max_job_bytes = std::size_t{1} << 20U;

/// Returns the content of a scan's `job.json`. Readers ignore unknown keys, and every version of
/// this program reads the files of earlier ones.
nlohmann::json to_job_json(const Job& job);

/// Returns the text of `job.json`. Invalid UTF-8 in names and messages is replaced.
std::string to_job_text(const Job& job);

/// Parses the JSON of a scan's `job.json`.
/// @throws Error "job-malformed"  with the key that is missing or wrong
Job to_job(const nlohmann::json& object);

/// Parses the text of a `job.json`. @throws Error "job-malformed"  also if it is too large
Job parse_job(std::string_view text);

/// Reads the `job.json` of a scan's folder. @throws Error "job-malformed", "read-failed"
Job read_job(const std::filesystem::path& folder);

}  // namespace octurn
