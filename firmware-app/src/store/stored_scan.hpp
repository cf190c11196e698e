#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Whether two scans have equal intrinsics, and, by laser line, the same distortion and names of
/// lasers. The lasers' planes may differ: they may have been measured in between.
bool have_same_sensor(const Scan& one, const Scan& other);

/// Returns the snapshots of a scan folder. A damaged one is logged, and replaced by one without
/// readings: the others still make a model.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop);

/// Stores one more snapshot: first its image, then the scan.json that names it.
/// @throws Error "disk-full", "write-failed"
void store_snapshot(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
                    const DepthFrame& frame);

/// Returns the files of a stop's pictures in a laser-line scan: "snapshots/000-dark.png", then one
/// for each laser by its name.
std::vector<std::string> picture_files(int stop, const LaserCamera& camera);

/// Writes one of these pictures, as RGB if any of its pixels has a colour.
/// @param colours  of its pixels; empty if the camera has none
/// @throws Error  as above
void write_picture(const std::filesystem::path& file, const Picture& picture,
                   const std::vector<Rgb>& colours);

/// Appends a stop whose pictures are all written, and writes the scan.json that names them.
/// @throws Error  as above
void store_stop(const std::filesystem::path& folder, Scan& scan, double angle);

/// Whether the first dark picture of a laser-line scan has colours; false if it cannot be read, and
/// for other scans.
bool has_colours(const std::filesystem::path& folder, const Scan& scan);

}  // namespace octurn
