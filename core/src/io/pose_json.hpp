#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The JSON of poses, boxes and solved poses in `scan.json`. Readers throw an Error that names the
/// wrong value.

Eigen::Vector3d point_from(const JsonValue& array);

Eigen::Isometry3d pose_from(const JsonValue& matrix);
nlohmann::json to_json(const Eigen::Isometry3d& pose);

Box box_from(const JsonValue& value);
nlohmann::json to_json(const Box& box);

nlohmann::json to_json(const SolvedPose& solved);

/// The sensor's pose: as configured, and as solved if it was.
struct RigPose {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  std::optional<SolvedPose> solved = {};
};

RigPose calibration_from(const JsonValue& calibration);
nlohmann::json to_json(const RigPose& calibration);

/// Maximum number of an object's poses in a scan.
inline constexpr int max_poses = 1000;

/// Reads the poses of a scan of version 2.
/// @param scan  supplies calibration and clip box to poses without their own
std::vector<ScanPose> poses_from(const JsonValue& poses, const Scan& scan);
nlohmann::json to_json(const std::vector<ScanPose>& poses);

}  // namespace octurn
