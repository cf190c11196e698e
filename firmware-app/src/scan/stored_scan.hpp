#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/take_pictures.hpp"

namespace octurn {

/// Whether two scans were made with one kind of sensor, or with one camera and its lasers, whose
/// planes may have been measured in between.
bool have_same_sensor(const Scan& one, const Scan& other);

/// The snapshots of a scan folder, where one that is damaged counts as one without a reading: the
/// others still make a model.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop);

/// Stores one more snapshot: first its image, then the scan.json that names it.
/// @throws Error "disk-full", "write-failed"
void store_snapshot(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
                    const DepthFrame& frame);

/// The files of the pictures of a stop, of a scan by laser line: "snapshots/000-dark.png", then one
/// of each laser by its name.
std::vector<std::string> picture_files(int stop, const LaserCamera& camera);

/// The same of a scan by laser line: its pictures, the dark one first, then one of each laser. The
/// dark one is stored as RGB if any of its pixels has a colour.
/// @throws Error  as above
void store_pictures(const std::filesystem::path& folder, Scan& scan, double angle,
                    const StopPictures& taken);

/// Whether the first dark picture of a scan by laser line has colours; false where it cannot be
/// read, and of other scans.
bool has_colours(const std::filesystem::path& folder, const Scan& scan);

}  // namespace octurn
