#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

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

/// Writes one of these pictures, as RGB if any of its pixels has a colour.
/// @param colours  of its pixels; empty if the camera has none
/// @throws Error  as above
void write_picture(const std::filesystem::path& file, const Picture& picture,
                   const std::vector<Rgb>& colours);

/// Writes the scan.json that names the pictures of one more stop, all of which are written.
/// @throws Error  as above
void store_stop(const std::filesystem::path& folder, Scan& scan, double angle);

/// Whether the first dark picture of a scan by laser line has colours; false where it cannot be
/// read, and of other scans.
bool has_colours(const std::filesystem::path& folder, const Scan& scan);

}  // namespace octurn
