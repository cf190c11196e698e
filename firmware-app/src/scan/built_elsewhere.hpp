#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "failure.hpp"
#include "scan/build_run.hpp"

namespace octurn {

// What the process that makes a build leaves in the folder of its task, for the one that waits for
// it. Each file appears whole or not at all.

inline constexpr const char* script_file = "job.sh";  ///< that the process is started by
inline constexpr const char* job_file = "job";        ///< its number on the cluster

/// Builds the model of the task in a folder: `Scan.stl`, then `build.json`; or `failure.json`.
/// @return false if stopped first
/// @throws Error  that `failure.json` tells, too
bool build_task_in(const std::filesystem::path& folder, const std::stop_token& stop);

/// Whether the build is there.
bool is_built(const std::filesystem::path& folder);

/// Why there is no build, if the process has told.
std::optional<Failure> read_failure(const std::filesystem::path& folder);

/// How far the process is: sets `phase` and `snapshots_done`, if it has told.
void read_progress(const std::filesystem::path& folder, BuildRun& run);

/// Removes all but the build.
void clear_work_files(const std::filesystem::path& folder);

}  // namespace octurn
