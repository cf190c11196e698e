#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "failure.hpp"
#include "scan/build_run.hpp"

namespace octurn {

// The files by which a process that makes a build reports to the one that waits for it, in the
// folder of its task. Each file appears whole or not at all.

inline constexpr const char* script_file = "job.sh";  ///< starts the process
inline constexpr const char* job_file = "job";        ///< its number on the cluster

/// Builds the model of the task in a folder: `Scan.stl`, then `build.json`; or `failure.json`.
/// @return false if stopped first
/// @throws Error  which is also in `failure.json`
bool build_task_in(const std::filesystem::path& folder, const std::stop_token& stop);

/// Whether the build is finished.
bool is_built(const std::filesystem::path& folder);

/// Why the build failed, if the process has written that.
std::optional<Failure> read_failure(const std::filesystem::path& folder);

/// Sets `phase` and `snapshots_done` from the process's progress file, if there is one.
void read_progress(const std::filesystem::path& folder, BuildRun& run);

/// Removes all files except the build's.
void clear_work_files(const std::filesystem::path& folder);

}  // namespace octurn
