#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/depth_frame.hpp"
#include "octurn/intrinsics.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// One stop of a scan: the depth image's file, relative to the scan folder, and the platform's
/// angle.
struct Shot {
  std::string file = {};
  double angle = 0.0;  // radians, counter-clockwise seen from above
};

/// What `scan.json` says (format "octurn-scan", version 1).
struct Scan {
  std::string sensor_name = {};
  Intrinsics intrinsics = {};
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  Box clip = {};  // metres, platform frame
  std::vector<Shot> shots = {};
};

/// Reads and checks the text of a `scan.json`. Keys that are not of the contract are passed over.
///
/// @throws Error  that names the key and what is wrong with it: missing, of the wrong kind, another
///                version, a file outside the folder, a matrix that is no rotation, no snapshots
Scan parse_scan(std::string_view text);

/// The same from `folder/scan.json`. @throws Error  also if there is no such file
Scan read_scan(const std::filesystem::path& folder);

/// Reads the depth image of one shot and puts it where it was seen from.
///
/// @throws Error  if the file is missing, is no 16-bit greyscale PNG, is damaged or cut short, or
///                has another size than `scan.json` says
Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot);

/// Writes `folder/scan.json`, whole or not at all, and returns when it is on the disk.
/// @throws Error  if the disk does not take it
void write_scan(const std::filesystem::path& folder, const Scan& scan);

/// The name of the shot that comes `index`-th: "snapshots/000.png".
std::string shot_file(int index);

/// Writes a depth image as 16-bit greyscale PNG, whole or not at all, and returns when it is on the
/// disk. Makes the file's folder where it is missing.
/// @throws Error  if the disk does not take it
void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame);

}  // namespace octurn
