#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "scan/build_model.hpp"
#include "scan/build_run.hpp"
#include "scan/scan_store.hpp"

namespace octurn {

/// The complete input of a build, for the worker or for a job on a cluster.
struct BuildTask {
  BuildRun run = {};
  bool becomes_model = false;
  Job job = {};                         ///< of the scan
  std::filesystem::path folder = {};    ///< the scan's own folder, or that of all its poses merged
  std::vector<std::string> poses = {};  ///< ids of the scans of other poses in that folder
  /// The findings of these scans; of one turn they are read when it is built.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// Makes the task of a build of a stored scan. It has the poses of the chosen model.
/// @throws Error "no-such-scan", "no-model"
BuildTask make_task(const ScanStore& store, const BuildRun& run, bool becomes_model);

/// Builds the model of a task. @param file  of the model, which appears whole or not at all
/// @return nothing if stopped first
/// @throws Error  as `build_model` for a scan
std::optional<Build> build_model(const BuildTask& task, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

/// Chooses a finished build as the scan's model, if the task asks for it or the scan has no model.
/// @throws Error  as `ScanStore::choose_build`
void choose_built(ScanStore& store, const BuildTask& task);

/// Writes a task and the builder's limits as `folder/task.json`, whole or not at all. @throws Error
/// "disk-full", "write-failed"
void write_task(const std::filesystem::path& folder, const BuildTask& task, const Limits& limits);

struct StoredTask {
  BuildTask task = {};
  Limits limits = {};
};

/// @throws Error "job-malformed", "read-failed"
StoredTask read_task(const std::filesystem::path& folder);

}  // namespace octurn
