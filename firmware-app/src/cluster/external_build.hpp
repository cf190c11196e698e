#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "failure.hpp"
#include "store/builds.hpp"

namespace octurn {

// Files through which a build process reports to the process that waits for it. They are in the
// task's folder, and each is written atomically.

inline constexpr const char* script_file = "job.sh";  ///< shell script that starts the process
inline constexpr const char* job_file = "job";        ///< job number on the cluster

/// Builds the model of the task in a folder. Writes `Scan.stl`, then `build.json`; after an error
/// `failure.json`.
/// @return false if stopped first
/// @throws Error  after writing it to `failure.json`
bool build_task_in(const std::filesystem::path& folder, const std::stop_token& stop);

/// Whether the build is finished.
bool is_built(const std::filesystem::path& folder);

/// Reads `failure.json`; nullopt if there is none.
std::optional<Failure> read_failure(const std::filesystem::path& folder);

/// Sets `phase` and `snapshots_done` from the process's `progress.json`, if there is one.
void read_progress(const std::filesystem::path& folder, BuildRun& run);

/// Removes all files except `Scan.stl` and `build.json`.
void clear_work_files(const std::filesystem::path& folder);

}  // namespace octurn
