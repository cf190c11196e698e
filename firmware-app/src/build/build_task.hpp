#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "build/build_model.hpp"
#include "store/build_run.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// The complete input of a build, for the worker or for a job on a cluster.
struct BuildTask {
  BuildRun run = {};
  bool becomes_model = false;
  Job job = {};                       ///< the scan's job
  std::filesystem::path folder = {};  ///< the scan's folder, or the scan folder of its merged poses
  std::vector<std::string> poses = {};  ///< ids of the scans of other poses in that folder
  /// Findings of the scans of all poses; nullopt for one turn, see `BuildInput`.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// Makes the task of building a stored scan, with the poses of the scan's chosen model.
/// @throws Error "no-such-scan", "no-model"
BuildTask make_task(const ScanStore& store, const BuildRun& run, bool becomes_model);

/// Builds the model of a task.
/// @param file  path of the model, which is written atomically
/// @return nullopt if stopped first
/// @throws Error  as `build_model` of a BuildInput
std::optional<Build> build_model(const BuildTask& task, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

/// Chooses a finished build as the scan's model, if the task asks for it or the scan has no model.
/// @throws Error  as `ScanStore::choose_build`
void choose_built(ScanStore& store, const BuildTask& task);

/// Writes a task and the builder's limits to `folder/task.json`, atomically.
/// @throws Error "disk-full", "write-failed"
void write_task(const std::filesystem::path& folder, const BuildTask& task, const Limits& limits);

struct StoredTask {
  BuildTask task = {};
  Limits limits = {};
};

/// Reads `folder/task.json`. @throws Error "job-malformed", "read-failed"
StoredTask read_task(const std::filesystem::path& folder);

}  // namespace octurn
