#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "scan/job.hpp"

namespace octurn {

/// A person's estimate of the object's pose in the scan of another pose.
struct PoseChoice {
  std::string pose = {};  ///< id of the scan
  /// Platform frame at angle 0 to the object's frame, metres: the start of the refinement.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  std::optional<std::size_t> candidate = {};  ///< of its registration; nothing: from pairs
};

/// The choice that a request's body makes: `{"candidate": 1}`, or `{"pairs_mm": [[[x, y, z],
/// [x, y, z]], ...]}` with at least three pairs of a point in the object's frame and the same in
/// the platform frame of the pose.
/// @param pose  the scan of that pose
/// @throws Error "bad-settings"  also if there is no such candidate, or the points lie on a line
PoseChoice pose_choice_from(const nlohmann::json& body, const Job& pose);

}  // namespace octurn
