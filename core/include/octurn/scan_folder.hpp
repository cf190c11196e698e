#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/depth_frame.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// An entry of a scan's list of snapshots.
struct Shot {
  std::string file = {};  ///< the depth image, relative to the scan folder
  double angle = 0.0;     ///< of the platform, radians, counter-clockwise seen from above
};

/// What `scan.json` says (format "octurn-scan", version 1).
struct Scan {
  std::string sensor_name = {};
  Intrinsics intrinsics = {};
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  Box clip = {};  ///< metres, platform frame
  std::vector<Shot> shots = {};
};

/// Reads and checks the text of a `scan.json`. Keys that are not of the contract are passed over.
///
/// @throws Error "scan-malformed"  that names the key and what is wrong with it: missing, of the
///                                 wrong kind, another version, a file outside the folder, a matrix
///                                 that is no rotation
/// @throws Error "scan-empty"      if it lists no snapshots
Scan parse_scan(std::string_view text);

/// The same from `folder/scan.json`. @throws Error "scan-missing"  also if there is no such file
Scan read_scan(const std::filesystem::path& folder);

/// Reads the depth image of one shot and its pose.
///
/// @throws Error "scan-missing"        if there is no such file
/// @throws Error "snapshot-malformed"  if it is no 16-bit greyscale PNG, is damaged or cut short,
/// or
///                                     has another size than `scan.json` says
Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot);

/// The snapshots of a scan folder, read from the disk each time they are asked for.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop = {});

/// Writes `folder/scan.json`, whole or not at all, and returns when it is on the disk.
/// @throws Error "disk-full", "write-failed"
void write_scan(const std::filesystem::path& folder, const Scan& scan);

/// The file of the shot of that index: "snapshots/000.png".
std::string shot_file(int index);

}  // namespace octurn
