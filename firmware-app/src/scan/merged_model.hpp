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

/// Turns that fit together.
struct MergedTurns {
  const std::vector<StoredTurn>& turns;
  const Registration& registration;
  const std::vector<std::string>& poses;  ///< ids of the scans of other poses that are among them
};

/// The other poses of a scan that are merged, but for one and those after it.
/// @param without  id of its scan
std::vector<std::string> merged_poses(const Job& first, const std::string& without);

/// The settings of a model of all poses: as the last one was scanned, with the first one's box.
BuildSettings merged_settings(const Job& first, const Job& pose);

/// What was found as the scans of several poses were taken; of the other ones the side is named.
/// @param poses  ids of the other ones
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

/// Registers the scan of another pose again, from where a person says that it lay, and builds the
/// model of all poses anew, which becomes the scan's; the one before it goes.
/// @param run  of that build
/// @return false if stopped first
/// @throws Error "no-model"  if it does not fit in that way: all stays as it was
bool refit_pose(ScanStore& store, const BuildRun& run, const PoseChoice& choice,
                const Limits& limits, const std::stop_token& stop, const BuildProgress& progress);

}  // namespace octurn
