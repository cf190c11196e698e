#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "scan/build_model.hpp"
#include "scan/build_run.hpp"
#include "scan/merged_scan.hpp"
#include "scan/pose_choice.hpp"
#include "scan/scan_store.hpp"

namespace octurn {

/// Registered turns.
struct MergedTurns {
  const std::vector<StoredTurn>& turns;
  const Registration& registration;
  const std::vector<std::string>& poses;  ///< ids of the scans of other poses in them
};

/// The merged other poses of a scan that come before a given one.
/// @param without  id of its scan
std::vector<std::string> merged_poses(const Job& first, const std::string& without);

/// The settings of a model of all poses: those of the last scan, with the first one's clip box.
BuildSettings merged_settings(const Job& first, const Job& pose);

/// The findings of the scans of several poses; those of other poses than the first name the side.
/// @param poses  ids of the other poses' scans
/// @return nothing if there are none
std::optional<std::vector<CalibrationFinding>> pose_findings(const ScanStore& store,
                                                             const Job& first,
                                                             const std::vector<std::string>& poses);

/// Builds the model of all poses, in a folder of a build that is begun by it.
/// @param number  of the build
/// @return nothing if stopped first
/// @throws Error  as `write_merged_scan` and `build_model`
std::optional<Build> build_merged(ScanStore& store, const Job& first, const MergedTurns& merged,
                                  const BuildSettings& settings, int number, const Limits& limits,
                                  const std::stop_token& stop, const BuildProgress& progress);

/// Registers the scan of another pose again, from a person's estimate, and builds the model of all
/// poses again. It replaces the scan's merged model.
/// @param run  of that build
/// @return false if stopped first
/// @throws Error "no-model"  if the estimate does not fit: then nothing is changed
bool refit_pose(ScanStore& store, const BuildRun& run, const PoseChoice& choice,
                const Limits& limits, const std::stop_token& stop, const BuildProgress& progress);

}  // namespace octurn
