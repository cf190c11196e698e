#pragma once

#include <filesystem>
#include <vector>

#include "build/merged_scan.hpp"

namespace octurn {

/// A file for display in the folder of another pose's scan: samples of the points of this scan and
/// of the earlier ones.
inline constexpr const char* pose_points_file = "pose-points.json";

/// Writes `{"before_mm": [[x, y, z], ...], "pose_mm": [...]}`: points of all turns except the last,
/// in the object's frame, and of the last one, in its platform frame at angle 0. About 100 kB.
///
/// @param points  of each turn, as `Registration` has them
/// @throws Error "disk-full", "write-failed"
void write_pose_points(const std::filesystem::path& folder, const std::vector<StoredTurn>& turns,
                       const std::vector<std::vector<Eigen::Vector3f>>& points);

}  // namespace octurn
