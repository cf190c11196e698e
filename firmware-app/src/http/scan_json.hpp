#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "scan/build_run.hpp"
#include "scan/job.hpp"

namespace octurn {

/// A scan as in web/API.md, except its preview and its other poses.
nlohmann::json to_json(const Job& job);

/// A scan of another pose as one of those of the first scan. @param number  of the pose, from 1
nlohmann::json pose_json(const Job& job, int number);

/// The scans of other poses of a scan, the oldest first.
nlohmann::json poses_json(const std::vector<Job>& poses);

/// A build as web/API.md has it, of the scan of that id. Number 0 is what the scan itself made.
nlohmann::json to_json(const Job& job, const Build& build);

/// The same of a build without a model.
nlohmann::json to_json(const BuildRun& run);

/// All builds of a scan, the one that it made itself first, and the one that goes on.
/// @param run  the build that goes on, or the last one, of any scan
nlohmann::json builds_json(const Job& job, const std::vector<BuildRun>& runs);

}  // namespace octurn
