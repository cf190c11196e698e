#pragma once

#include <filesystem>
#include <vector>

#include "scan/merged_scan.hpp"

namespace octurn {

/// In the folder of a scan of another pose: some of the points that it saw, and that were seen
/// before, for people to look at.
inline constexpr const char* pose_points_file = "pose-points.json";

/// Writes `{"before_mm": [[x, y, z], ...], "pose_mm": [...]}`: what all turns but the last saw, in
/// the object's frame, and what the last one saw, in its platform's frame at angle 0. Some 100 kB.
///
/// @param points  of each turn, as `Registration` has them
/// @throws Error "disk-full", "write-failed"
void write_pose_points(const std::filesystem::path& folder, const std::vector<StoredTurn>& turns,
                       const std::vector<std::vector<Eigen::Vector3f>>& points);

}  // namespace octurn
