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

/// All that a build works on: what the worker makes a model of, or a job on a cluster.
struct BuildTask {
  BuildRun run = {};
  bool becomes_model = false;
  Job job = {};                         ///< of the scan
  std::filesystem::path folder = {};    ///< the scan folder: its own, or that of all its poses
  std::vector<std::string> poses = {};  ///< ids of the scans of other poses that are in it
  /// What was found as these were scanned; of one turn it is found as it is built.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// What a build of a stored scan works on: the poses are those of the model that is chosen.
/// @throws Error "no-such-scan", "no-model"
BuildTask make_task(const ScanStore& store, const BuildRun& run, bool becomes_model);

/// Builds the model of a task. @param file  of the model, which appears whole or not at all
/// @return nothing if stopped first
/// @throws Error  as `build_model` for a scan
std::optional<Build> build_model(const BuildTask& task, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

/// Makes a build that is kept the scan's model, if the task asks for it or there is none.
/// @throws Error  as `ScanStore::choose_build`
void choose_built(ScanStore& store, const BuildTask& task);

/// A task, and the limits of who makes it, as `folder/task.json`, which appears whole or not at
/// all. @throws Error "disk-full", "write-failed"
void write_task(const std::filesystem::path& folder, const BuildTask& task, const Limits& limits);

struct StoredTask {
  BuildTask task = {};
  Limits limits = {};
};

/// @throws Error "job-malformed", "read-failed"
StoredTask read_task(const std::filesystem::path& folder);

}  // namespace octurn
