#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "build/build_model.hpp"
#include "build/merged_scan.hpp"
#include "store/build_run.hpp"
#include "store/pose_choice.hpp"
#include "store/scan_store.hpp"

namespace octurn {

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
