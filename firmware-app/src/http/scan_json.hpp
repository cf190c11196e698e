#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "store/builds.hpp"
#include "store/job.hpp"

namespace octurn {

/// A scan as in web/API.md, except its preview and its other poses.
nlohmann::json to_json(const Job& job);

/// A scan in another pose, as an entry of `poses` of the first scan.
/// @param number  of the pose, from 1
nlohmann::json pose_json(const Job& job, int number);

/// The array `poses` of a scan. @param poses  its scans in other poses, oldest first
nlohmann::json poses_json(const std::vector<Job>& poses);

/// A finished build of a scan as in web/API.md. Number 0 is the model that the scan itself made.
nlohmann::json to_json(const Job& job, const Build& build);

/// A build that runs, or ended without a model.
nlohmann::json to_json(const BuildRun& run);

/// All builds of a scan: the model that it made itself, the stored builds, and those that run or
/// ended without a model. @param runs  of any scan
nlohmann::json builds_json(const Job& job, const std::vector<BuildRun>& runs);

}  // namespace octurn
