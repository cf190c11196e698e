#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Poses, boxes and what was solved, as `scan.json` has them. Reading throws the Error of a value
/// that is wrong.

Eigen::Vector3d point_from(const JsonValue& array);

Eigen::Isometry3d pose_from(const JsonValue& matrix);
nlohmann::json to_json(const Eigen::Isometry3d& pose);

Box box_from(const JsonValue& value);
nlohmann::json to_json(const Box& box);

nlohmann::json to_json(const SolvedPose& solved);

/// Where the sensor stands: as told, and as solved if that is there.
struct RigPose {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  std::optional<SolvedPose> solved = {};
};

RigPose calibration_from(const JsonValue& calibration);
nlohmann::json to_json(const RigPose& calibration);

/// The poses of a scan of version 2. @param scan  whose calibration and clip box those have that
/// tell none of their own
std::vector<ScanPose> poses_from(const JsonValue& poses, const Scan& scan);
nlohmann::json to_json(const std::vector<ScanPose>& poses);

}  // namespace octurn
