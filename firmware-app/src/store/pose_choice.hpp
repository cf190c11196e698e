#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "store/job.hpp"

namespace octurn {

/// A person's estimate of the object's pose in the scan of another pose.
struct PoseChoice {
  std::string pose = {};  ///< id of the scan
  /// Platform frame at angle 0 to the object's frame, metres: the start of the refinement.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  std::optional<std::size_t> candidate = {};  ///< index; nullopt: from pairs of points
};

/// Parses a request's body: `{"candidate": 1}`, or `{"pairs_mm": [[[x, y, z], [x, y, z]], ...]}`
/// with at least three pairs of a point in the object's frame and the same point in the pose's
/// platform frame.
/// @param pose  the scan of that pose
/// @throws Error "bad-settings"  also if there is no such candidate, or the points are collinear
PoseChoice pose_choice_from(const nlohmann::json& body, const Job& pose);

}  // namespace octurn
