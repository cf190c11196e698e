#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "build/merged_scan.hpp"
#include "octurn/calibrate.hpp"
#include "store/builds.hpp"
#include "store/job.hpp"
#include "store/pose_choice.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// The input of a build.
struct BuildInput {
  const Job& job;                       ///< the scan's job
  const std::filesystem::path& folder;  ///< the scan's folder, or that of its merged poses
  const BuildSettings& settings;
  /// Findings of all poses' scans, for a model of several poses. nullopt for one turn: its findings
  /// are determined during the build.
  std::optional<std::vector<CalibrationFinding>> findings = {};
};

/// Called on any thread with the phase of a build and the number of snapshots read.
using BuildProgress = std::function<void(Phase phase, int snapshots_done)>;

/// Builds a model from the stored snapshots of a scan, and rates its quality. The settings decide
/// whether the sensor's pose is the configured one, the scan's solved one, or one that is solved
/// here.
///
/// @param file  path of the model, which is written atomically
/// @return a build without number and creation time; nullopt if stopped first
/// @throws Error  if the scan cannot be read, has no surface, or the disk is full
std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress);

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

/// Turns and their registration.
struct MergedTurns {
  const std::vector<StoredTurn>& turns;
  const Registration& registration;
  const std::vector<std::string>& poses;  ///< ids of the scans of other poses among the turns
};

/// Returns the ids of the scans of other poses that were merged before a given one.
/// @param without  id of the given pose's scan
std::vector<std::string> merged_poses(const Job& first, const std::string& without);

/// Returns the settings of a model of all poses: those of the last scan, with the first one's clip
/// box.
BuildSettings merged_settings(const Job& first, const Job& pose);

/// Returns the findings of the scans of all poses. Those of the second and later poses name the
/// side of the object in their messages.
/// @param poses  ids of the other poses' scans
/// @return nullopt if `poses` is empty
std::optional<std::vector<CalibrationFinding>> pose_findings(const ScanStore& store,
                                                             const Job& first,
                                                             const std::vector<std::string>& poses);

/// Begins a build, and builds the model of all poses in its folder.
/// @param number  of the build
/// @return nullopt if stopped first
/// @throws Error  as `write_merged_scan` and `build_model`
std::optional<Build> build_merged(ScanStore& store, const Job& first, const MergedTurns& merged,
                                  const BuildSettings& settings, int number, const Limits& limits,
                                  const std::stop_token& stop, const BuildProgress& progress);

/// Registers the scan of another pose again, starting at a person's estimate, and builds the model
/// of all poses again, which replaces the scan's merged model.
/// @param run  of that build
/// @return false if stopped first
/// @throws Error "no-model"  if the registration is refused: then nothing is changed
bool refit_pose(ScanStore& store, const BuildRun& run, const PoseChoice& choice,
                const Limits& limits, const std::stop_token& stop, const BuildProgress& progress);

}  // namespace octurn
